//! `runs/*.db3`, and folders that `ros2 bag record` makes: several files that are one log, packed or not.
//!
//! Source: <https://github.com/ros2/rosbag2>, `rosbag2_storage` and `rosbag2_storage_sqlite3`.

mod database;
mod folder;

use super::messages::{self, OpenMessages};
use super::{Layout, ReadLogs};

/// What tells that a folder is a bag.
const METADATA: &str = "metadata.yaml";

pub(super) const LAYOUT: Layout = Layout::new(
    "rosbag2",
    "the same with bags of ROS 2, folders of `ros2 bag record` or runs/*.db3; one run as the bag",
)
.reads_data((|probe| if probe.is_folder { probe.has(METADATA) } else { probe.extension() == "db3" }, messages::read))
.reads_messages(OpenMessages { magic: b"SQLite format 3\0", open: |path, _| database::open(path) })
.reads_folders((METADATA, folder::open))
.reads_logs(ReadLogs {
    ending: "db3",
    add: |assembly, file, _, topics| messages::add(assembly, file, topics),
    look: messages::look,
});
