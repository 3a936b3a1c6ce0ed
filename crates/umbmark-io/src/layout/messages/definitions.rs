//! Message definitions of ROS 2: written into logs, so that every tool can decode them, and for bags that do not bring theirs along.
//!
//! Source: common_interfaces, geometry2 and rcl_interfaces of ROS 2, without comments.

const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const POSE: (&str, &str) =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: (&str, &str) = ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n");
const POSE_WITH_COVARIANCE: (&str, &str) =
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n");
const TRANSFORM: (&str, &str) =
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n");
const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");

/// The type of a message, its own definition, and those that it needs.
pub(in crate::layout) struct KnownType {
    /// As ROS 2 writes it, with the folder.
    pub name: &'static str,
    own: &'static str,
    needs: &'static [(&'static str, &'static str)],
}

pub(in crate::layout) const JOINT_STATE: KnownType = KnownType {
    name: "sensor_msgs/msg/JointState",
    own: "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    needs: &[HEADER, TIME],
};

pub(in crate::layout) const ODOMETRY: KnownType = KnownType {
    name: "nav_msgs/msg/Odometry",
    own: "std_msgs/Header header\nstring child_frame_id\n\
          geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n",
    needs: &[
        HEADER,
        TIME,
        POSE_WITH_COVARIANCE,
        POSE,
        POINT,
        QUATERNION,
        ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
        ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
        VECTOR,
    ],
};

pub(in crate::layout) const POSE_STAMPED: KnownType = KnownType {
    name: "geometry_msgs/msg/PoseStamped",
    own: STAMPED_POSE.1,
    needs: &[HEADER, TIME, POSE, POINT, QUATERNION],
};

pub(in crate::layout) const TF: KnownType = KnownType {
    name: "tf2_msgs/msg/TFMessage",
    own: "geometry_msgs/TransformStamped[] transforms\n",
    needs: &[("geometry_msgs/TransformStamped", TRANSFORM_STAMPED.own), HEADER, TIME, TRANSFORM, VECTOR, QUATERNION],
};

/// Types that a bag without definitions may have.
pub(in crate::layout) const DEFINITIONS: [&KnownType; 16] = [
    &JOINT_STATE,
    &ODOMETRY,
    &POSE_STAMPED,
    &TF,
    &PATH,
    &POSE_WITH_COVARIANCE_STAMPED,
    &TRANSFORM_STAMPED,
    &STRING,
    &INT16_LIST,
    &INT32_LIST,
    &INT64_LIST,
    &INT8_LIST,
    &UINT16_LIST,
    &UINT32_LIST,
    &UINT64_LIST,
    &UINT8_LIST,
];

const POSE_WITH_COVARIANCE_STAMPED: KnownType = KnownType {
    name: "geometry_msgs/msg/PoseWithCovarianceStamped",
    own: "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
    needs: &[HEADER, TIME, POSE_WITH_COVARIANCE, POSE, POINT, QUATERNION],
};

const TRANSFORM_STAMPED: KnownType = KnownType {
    name: "geometry_msgs/msg/TransformStamped",
    own: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    needs: &[HEADER, TIME, TRANSFORM, VECTOR, QUATERNION],
};

const STRING: KnownType = KnownType { name: "std_msgs/msg/String", own: "string data\n", needs: &[] };

/// A list of integers of a type.
macro_rules! list {
    ($($LIST:ident $name:literal of $number:literal;)*) => {
        $(const $LIST: KnownType = KnownType {
            name: concat!("std_msgs/msg/", $name, "MultiArray"),
            own: concat!("std_msgs/MultiArrayLayout layout\n", $number, "[] data\n"),
            needs: &[
                ("std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"),
                ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
            ],
        };)*
    };
}
list! {
    INT8_LIST "Int8" of "int8";
    INT16_LIST "Int16" of "int16";
    INT32_LIST "Int32" of "int32";
    INT64_LIST "Int64" of "int64";
    UINT8_LIST "UInt8" of "uint8";
    UINT16_LIST "UInt16" of "uint16";
    UINT32_LIST "UInt32" of "uint32";
    UINT64_LIST "UInt64" of "uint64";
}

const STAMPED_POSE: (&str, &str) = ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n");
const COLOR: (&str, &str) = ("std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n");

pub(in crate::layout) const PATH: KnownType = KnownType {
    name: "nav_msgs/msg/Path",
    own: "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    needs: &[HEADER, TIME, STAMPED_POSE, POSE, POINT, QUATERNION],
};

pub(in crate::layout) const MARKER_ARRAY: KnownType = KnownType {
    name: "visualization_msgs/msg/MarkerArray",
    own: "visualization_msgs/Marker[] markers\n",
    needs: &[
        (
            "visualization_msgs/Marker",
            "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n\
             geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n\
             bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n\
             sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n\
             string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
        ),
        HEADER,
        TIME,
        POSE,
        POINT,
        QUATERNION,
        VECTOR,
        COLOR,
        ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
        ("sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"),
        ("visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"),
        ("visualization_msgs/MeshFile", "string filename\nuint8[] data\n"),
    ],
};

impl KnownType {
    /// The definition with all that it needs, in the form `ros2msg`.
    pub fn text(&self) -> String {
        let rule = "=".repeat(80);
        let needed = self.needs.iter().map(|(name, own)| format!("{rule}\nMSG: {name}\n{own}"));
        self.own.to_owned() + &needed.collect::<String>()
    }
}
