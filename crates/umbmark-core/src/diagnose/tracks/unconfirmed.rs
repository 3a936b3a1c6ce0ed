//! An effect of the catalogue that is significant by F and predicts held-out runs better, but that the runs are too few to certify.

use super::growth;
use super::search::Search;
use crate::diagnose::options::Options;
use crate::diagnose::reason::Reason;
use crate::diagnose::suspect::Suspect;
use crate::evidence::FitError;

/// p by F of one effect alone below which it is fitted.
const LOUD: f64 = 1e-6;
/// The error of positions or headings in held-out runs must fall by this share with it.
const TELLING: f64 = 0.1;
/// So many effects are fitted.
const TRIES: usize = 2;

/// The reason for doubt of such an effect.
///
/// Two runs that differ have hardly a sign to flip, and an effect that is there may stay uncertified whatever F says. Held-out runs that are
/// predicted better by a tenth do not prove it either, but a model without it does not explain these runs.
pub(super) fn unconfirmed(search: &Search, options: &Options) -> Result<Option<Reason>, FitError> {
    let is_loud =
        |suspect: &&Suspect| suspect.p < LOUD && suspect.p_adjusted > options.size && !search.is_refused(suspect.best);
    for suspect in search.left.asked.iter().filter(is_loud).take(TRIES) {
        let Some(fall) = fall_with(search, suspect)? else { continue };
        let Suspect { class, p, p_adjusted, .. } = suspect.clone();
        return Ok(Some(Reason::Unconfirmed { class, p, p_adjusted, fall }));
    }
    Ok(None)
}

/// By which share the error of held-out positions or headings falls with an effect, where it may be that of a robot and neither rises.
fn fall_with(search: &Search, suspect: &Suspect) -> Result<Option<f64>, FitError> {
    let Some(grown) = search.tried(growth::grown(search.last(), suspect)?, suspect.best)? else { return Ok(None) };
    let before = &search.written[search.written.len() - 1];
    let [least, most] = grown.left_out().falls(&before.left_out());
    Ok((least >= 0.0 && most >= TELLING).then_some(most))
}
