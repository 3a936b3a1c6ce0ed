//! What a log holds, and what of it would be read, before anything is known of its robot.

use super::container::Record;
use super::decoder::Decoder;
use super::fields::{Fields, Layout, Slot};
use super::message_type::Encoding;
use super::topics::{Topic, shown};
use super::{Gathered, Survey, Topics};
use crate::contents::rolls_over;
use crate::error::DatasetError;
use crate::remedy::Words;
use std::path::Path;
use umbmark_core::drive::DriveKind;
use umbmark_core::inspect::{LogContents, LogPart, ReferenceFound, WheelUnit, WheelsFound, usual_rate};

/// Looks through a log.
///
/// # Errors
///
/// Where the file cannot be opened or is no log of messages. What keeps wheels or poses from being read is told in the contents.
pub(in crate::layout) fn look(file: &Path, topics: &Topics, words: &Words) -> Result<LogContents, DatasetError> {
    let mut survey = Survey::open(file)?;
    let any = |_: &super::Wheels| Ok(());
    let said = |error: DatasetError| match error {
        DatasetError::Messages { problem, .. } => problem.worded(words),
        error => error.worded(words),
    };
    let mut warnings = Vec::new();
    let mut poses = Ok(());
    let mut gathered = survey.gather(topics, &any, &mut warnings);
    if let Err(error) = &gathered {
        warnings.clear();
        // It may be the poses that cannot be read.
        let without = Topics { reference: Some("none".to_owned()), ..topics.clone() };
        let alone = survey.gather(&without, &any, &mut warnings);
        if alone.is_ok() {
            poses = Err(said(error.clone()));
            gathered = alone;
        }
    }
    let gathered = gathered.map_err(said);
    let read = gathered.as_ref().map_or([""; 2], |gathered| [&gathered.topics[0], &gathered.topics[1]]);
    let parts = survey.topics.iter().map(|topic| part(&survey, topic, read)).collect();
    let reference = poses.map(|()| gathered.as_ref().ok().and_then(reference));
    let wheels = gathered.and_then(|gathered| wheels(gathered, &survey.file, words));
    let (file, duration) = (survey.file.clone(), survey.duration());
    let before = format!("{file}: ");
    let notes = warnings.into_iter().map(|note| note.strip_prefix(&before).unwrap_or(&note).to_owned()).collect();
    let (robot, urdf, layout) = (survey.robot().map(str::to_owned), description(&mut survey), survey.layout);
    Ok(LogContents { file, layout, duration, parts, wheels, reference, notes, robot, urdf })
}

/// The description of the robot that was recorded, where there is one that can be read.
fn description(survey: &mut Survey) -> Option<String> {
    let is_description = |topic: &&Topic| topic.name.rsplit('/').next() == Some("robot_description");
    let topic = survey.topics.iter().find(is_description)?.name.clone();
    let (channel, encoding, schema) = survey.channels_of(&topic).next()?;
    let layout = Layout::default().need("data", Slot::Frame);
    let decoder =
        Decoder::of_layout(Encoding::of(encoding, &schema.encoding)?, layout, &schema.name, &schema.data).ok()?;
    let (mut fields, mut text) = (Fields::default(), None);
    let walked = survey.walk(&|of| of == channel, &mut |record| {
        if let Record::Message { channel: of, data, .. } = record
            && of == channel
            && text.is_none()
        {
            let read = decoder.read(data, &mut fields, &mut |fields| {
                text = Some(fields.frame.clone());
                Ok::<(), ()>(())
            });
            // What cannot be read describes nothing.
            let _ = read;
        }
        Ok(())
    });
    walked.ok().and(text).filter(|text| text.contains("<robot"))
}

fn part(survey: &Survey, topic: &Topic, read: [&str; 2]) -> LogPart {
    let (name, count) = (shown(&topic.name), survey.messages(topic));
    let used = ["wheels", "reference"].into_iter().zip(read).find(|(_, read)| *read == name).map(|(role, _)| role);
    let rate = survey.duration().filter(|_| count > 1).map(|seconds| (count - 1) as f64 / seconds);
    LogPart { name, kind: shown(&topic.schema), count: Some(count), rate, used }
}

fn reference(gathered: &Gathered) -> Option<ReferenceFound> {
    let poses = &gathered.track.poses;
    (!poses.is_empty()).then(|| ReferenceFound {
        source: gathered.topics[1].clone(),
        poses: poses.len(),
        headings: poses.iter().filter(|(.., heading)| heading.is_some()).count(),
        rate: usual_rate(&gathered.track.time),
    })
}

fn wheels(gathered: Gathered, file: &str, words: &Words) -> Result<WheelsFound, String> {
    let Gathered { wheels, clock, topics: [topic, _], .. } = gathered;
    let (unit, parts, ticks_per_revolution) = wheels.found();
    let source = parts.map_or_else(|| topic.clone(), |parts| format!("{topic}, {parts}"));
    let recording = wheels.into_recording(file, &topic, &clock, None, &mut Vec::new());
    let rate = usual_rate(&recording.time).ok_or_else(|| format!("{topic} has fewer than two readings"))?;
    let readings = recording.time.len();
    let counter_bits = if unit == WheelUnit::Counts { rolls_over(recording, words)? } else { None };
    Ok(WheelsFound { source, unit, drive: DriveKind::default(), readings, rate, ticks_per_revolution, counter_bits })
}
