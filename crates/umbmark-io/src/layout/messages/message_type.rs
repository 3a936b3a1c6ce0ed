//! Types of messages that mean something here, and what is read of them.

use super::fields::{Layout, Number, Slot};
use super::schema::{Count, FieldType, Schema};
use serde_json::Value;

/// What a message is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) enum MessageType {
    /// Integers called left and right, by the paths of these fields.
    Counts { left: String, right: String },
    /// A list of integers, which does not say what they are: std_msgs/Int*MultiArray.
    CountList,
    /// sensor_msgs/JointState
    Joints,
    /// nav_msgs/Odometry
    Odometry,
    /// A pose with a stamp, in one of its types.
    Pose(PoseType),
    /// geometry_msgs/TransformStamped
    Transform,
    /// tf2_msgs/TFMessage
    Transforms,
    /// sensor_msgs/Imu: its rate of turning.
    Imu,
}

/// Types of a pose with a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum PoseType {
    /// geometry_msgs/PoseStamped
    Stamped,
    /// geometry_msgs/PoseWithCovarianceStamped
    WithCovariance,
    /// foxglove.PoseInFrame
    InFrame,
}

/// How messages of a topic are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Encoding {
    /// ROS 2: CDR with a `ros2msg` schema.
    Cdr,
    /// ROS 1: its own packed form with a `ros1msg` schema.
    Ros1,
    Json,
    Protobuf,
}

impl Encoding {
    pub fn of(message: &str, schema: &str) -> Option<Encoding> {
        match (message, schema) {
            ("cdr", "ros2msg") => Some(Encoding::Cdr),
            ("ros1", "ros1msg") => Some(Encoding::Ros1),
            ("json", _) => Some(Encoding::Json),
            ("protobuf", "protobuf") => Some(Encoding::Protobuf),
            _ => None,
        }
    }
}

impl MessageType {
    /// The type called `name`, or the one that its schema resembles.
    pub fn of(encoding: Encoding, name: &str, schema: &[u8]) -> Option<MessageType> {
        MessageType::named(name).or_else(|| match encoding {
            Encoding::Cdr | Encoding::Ros1 => counts(&integers(&Schema::parse(name, schema).ok()?)),
            Encoding::Json => counts(&integers_of_json(schema)?),
            Encoding::Protobuf => None,
        })
    }

    fn named(name: &str) -> Option<MessageType> {
        const PACKAGES: [&str; 8] =
            ["", "sensor_msgs", "nav_msgs", "geometry_msgs", "tf2_msgs", "std_msgs", "foxglove", "foxglove_msgs"];
        let (package, last) = name.rsplit_once(['/', '.']).unwrap_or(("", name));
        if !PACKAGES.contains(&package.trim_end_matches("/msg")) {
            return None;
        }
        Some(match last {
            "JointState" => MessageType::Joints,
            "Odometry" => MessageType::Odometry,
            "PoseStamped" => MessageType::Pose(PoseType::Stamped),
            "PoseWithCovarianceStamped" => MessageType::Pose(PoseType::WithCovariance),
            "PoseInFrame" => MessageType::Pose(PoseType::InFrame),
            "TransformStamped" => MessageType::Transform,
            "TFMessage" => MessageType::Transforms,
            "Imu" => MessageType::Imu,
            _ if last.ends_with("MultiArray") && last.contains("Int") => MessageType::CountList,
            _ => return None,
        })
    }

    /// What is read of it.
    pub fn layout(&self) -> Layout {
        let header = || Layout::default().stamp("header.stamp");
        let framed = || header().need("header.frame_id", Slot::Frame);
        match self {
            MessageType::Counts { left, right } => {
                header().need(left, Slot::Number(Number::Left)).need(right, Slot::Number(Number::Right))
            }
            MessageType::CountList => Layout::default().need("data", Slot::Values),
            MessageType::Joints => header().need("name", Slot::Names).need("position", Slot::Values),
            MessageType::Odometry => framed()
                .need("child_frame_id", Slot::Child)
                .pose("pose.pose.position", "pose.pose.orientation")
                .need("twist.twist.linear.x", Slot::Number(Number::Speed))
                .need("twist.twist.angular.z", Slot::Number(Number::TurnRate)),
            MessageType::Imu => framed().need("angular_velocity.z", Slot::Number(Number::TurnRate)),
            MessageType::Pose(PoseType::Stamped) => framed().pose("pose.position", "pose.orientation"),
            MessageType::Pose(PoseType::WithCovariance) => framed().pose("pose.pose.position", "pose.pose.orientation"),
            MessageType::Pose(PoseType::InFrame) => Layout::default()
                .stamp("timestamp")
                .need("frame_id", Slot::Frame)
                .pose("pose.position", "pose.orientation"),
            MessageType::Transform | MessageType::Transforms => Layout {
                each: (*self == MessageType::Transforms).then_some("transforms"),
                ..framed().need("child_frame_id", Slot::Child).pose("transform.translation", "transform.rotation")
            },
        }
    }
}

/// The fields called left and right, where there is one of each.
fn counts(integers: &[String]) -> Option<MessageType> {
    let only = |side: &str| {
        let mut found = integers.iter().filter(|name| name.to_lowercase().contains(side));
        found.next().filter(|_| found.next().is_none()).cloned()
    };
    Some(MessageType::Counts { left: only("left")?, right: only("right")? })
}

fn integers(schema: &Schema) -> Vec<String> {
    let fields = schema.fields(&schema.root).unwrap_or_default();
    let integer = |kind: &FieldType| matches!(kind, FieldType::Primitive(primitive) if primitive.is_integer());
    let integers = fields.iter().filter(|field| integer(&field.kind) && field.count == Count::One);
    integers.map(|field| field.name.clone()).collect()
}

fn integers_of_json(schema: &[u8]) -> Option<Vec<String>> {
    let schema: Value = serde_json::from_slice(schema).ok()?;
    let properties = schema.get("properties")?.as_object()?;
    let integers = properties.iter().filter(|(_, property)| property.get("type").is_some_and(|t| t == "integer"));
    Some(integers.map(|(name, _)| name.clone()).collect())
}
