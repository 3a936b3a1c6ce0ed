//! `runs/*.mcap`: logs of ROS 2 and of Foxglove. `write` is the way back.
//!
//! Source: the specification of MCAP (<https://mcap.dev/spec>) and its registry of encodings.

mod container;
mod parts;
mod save;
mod scene;
mod write;

pub use save::save_mcap;
pub(crate) use write::corrected;
#[cfg(test)]
pub(super) use write::write;

use super::messages::{self, OpenMessages};
use super::{Layout, ReadLogs};

pub(super) const LAYOUT: Layout = Layout::new("mcap", "the same with logs of ROS 2, runs/*.mcap; one run as NAME.mcap")
    .reads_data((|probe| probe.extension() == "mcap", messages::read))
    .reads_messages(OpenMessages { magic: mcap::MAGIC, open: |_, file| container::open(file) })
    .reads_logs(ReadLogs {
        ending: "mcap",
        add: |assembly, file, _, topics| messages::add(assembly, file, topics),
        look: messages::look,
    })
    .writes(|data, place, existing| save_mcap(data, place, existing));
