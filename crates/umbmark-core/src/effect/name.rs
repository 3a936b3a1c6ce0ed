//! Names that live as long as the program.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// The same text with a static lifetime; each different text is stored once.
///
/// Names of effects and parameters come from the catalogue or from a user's files. Results carry them, and outlive the model that they are
/// about; a notebook that loads the same file in a loop needs no more memory for it.
pub(super) fn lasting(text: &str) -> &'static str {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(text) {
        return known;
    }
    let name: &'static str = Box::leak(text.into());
    names.insert(name);
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_once_however_often_it_is_asked_for() {
        let first = lasting("a name of this test");
        assert!(std::ptr::eq(first, lasting(&String::from("a name of this test"))));
        assert_eq!(first, "a name of this test");
    }
}
