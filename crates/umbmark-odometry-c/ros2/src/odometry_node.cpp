// Corrected wheel odometry as a node of ROS 2: joint states in, odometry with covariance out.
//
// Parameters: joints (the left and the right wheel, or drive and steering), frame_id, child_frame_id, publish_tf, and final_only (publish
// poses when they are final, up to 0.05 s late, where the model depends on the speed of the wheels; else that of the newest reading).

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <geometry_msgs/msg/transform_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <tf2_ros/transform_broadcaster.h>

#include "umbmark_odometry.h"
#include UMBMARK_MODEL

namespace
{
constexpr double kTurn = 6.283185307179586;
constexpr std::size_t kNumbers = sizeof umbmark_model / sizeof *umbmark_model;
// The variance of what is not told.
constexpr double kUnknown = 1e6;
}  // namespace

class OdometryNode : public rclcpp::Node
{
public:
  OdometryNode() : Node("umbmark_odometry")
  {
    joints_ = declare_parameter("joints", std::vector<std::string>{"left_wheel_joint", "right_wheel_joint"});
    frame_ = declare_parameter("frame_id", std::string("odom"));
    child_ = declare_parameter("child_frame_id", std::string("base_link"));
    final_only_ = declare_parameter("final_only", false);
    if (joints_.size() != 2) {
      throw std::invalid_argument("joints must be two names");
    }
    check(umbmark_counts_per_turn(umbmark_model, kNumbers, counts_per_turn_.data()));
    check(umbmark_begin(&odometer_, umbmark_model, kNumbers));
    if (declare_parameter("publish_tf", true)) {
      broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>(*this);
    }
    publisher_ = create_publisher<nav_msgs::msg::Odometry>("odom", rclcpp::SystemDefaultsQoS());
    subscription_ = create_subscription<sensor_msgs::msg::JointState>(
      "joint_states", rclcpp::SensorDataQoS(),
      [this](const sensor_msgs::msg::JointState & message) { on_joints(message); });
  }

private:
  static void check(umbmark_status status)
  {
    if (status != UMBMARK_OK) {
      throw std::runtime_error(std::string("model: ") + umbmark_status_text(status));
    }
  }

  void on_joints(const sensor_msgs::msg::JointState & message)
  {
    std::array<double, 2> counts;
    for (std::size_t wheel = 0; wheel < 2; ++wheel) {
      std::size_t at = 0;
      while (at < message.name.size() && message.name[at] != joints_[wheel]) {
        ++at;
      }
      if (at >= message.name.size() || at >= message.position.size()) {
        return;  // of other joints
      }
      counts[wheel] = message.position[at] / kTurn * counts_per_turn_[wheel];
    }
    const rclcpp::Time stamp(message.header.stamp);
    if (!begun_) {
      first_ = stamp;
      begun_ = true;
    }
    umbmark_estimate now;
    auto status = umbmark_update(&odometer_, (stamp - first_).seconds(), counts[0], counts[1], &now);
    if (status == UMBMARK_OK && !final_only_) {
      status = umbmark_ahead(&odometer_, &now);
    }
    if (status != UMBMARK_OK) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 5000, "%s", umbmark_status_text(status));
      return;
    }
    if (!told_ || now.time_s > last_.time_s) {
      publish(now);
      last_ = now;
      told_ = true;
    }
  }

  void publish(const umbmark_estimate & now)
  {
    nav_msgs::msg::Odometry odometry;
    odometry.header.stamp = first_ + rclcpp::Duration::from_seconds(now.time_s);
    odometry.header.frame_id = frame_;
    odometry.child_frame_id = child_;
    odometry.pose.pose.position.x = now.x_m;
    odometry.pose.pose.position.y = now.y_m;
    odometry.pose.pose.orientation.z = std::sin(0.5 * now.heading_rad);
    odometry.pose.pose.orientation.w = std::cos(0.5 * now.heading_rad);
    // x, y, z and the turns about them: the plane is 0, 1 and 5.
    auto & pose = odometry.pose.covariance;
    const auto & c = now.covariance;
    pose[0] = c[0];
    pose[1] = pose[6] = c[1];
    pose[7] = c[2];
    pose[5] = pose[30] = c[3];
    pose[11] = pose[31] = c[4];
    pose[35] = c[5];
    if (!now.covariance_known) {
      pose[0] = pose[7] = pose[35] = kUnknown;
    }
    pose[14] = pose[21] = pose[28] = kUnknown;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      odometry.twist.covariance[7 * axis] = kUnknown;
    }
    if (told_) {
      // The mean motion since the last pose. Its covariance is not told: filters take the poses.
      const double seconds = now.time_s - last_.time_s;
      const double middle = 0.5 * (now.heading_rad + last_.heading_rad);
      const double dx = now.x_m - last_.x_m, dy = now.y_m - last_.y_m;
      odometry.twist.twist.linear.x = (std::cos(middle) * dx + std::sin(middle) * dy) / seconds;
      odometry.twist.twist.linear.y = (std::cos(middle) * dy - std::sin(middle) * dx) / seconds;
      odometry.twist.twist.angular.z = (now.heading_rad - last_.heading_rad) / seconds;
    }
    publisher_->publish(odometry);
    if (broadcaster_) {
      geometry_msgs::msg::TransformStamped transform;
      transform.header = odometry.header;
      transform.child_frame_id = child_;
      transform.transform.translation.x = now.x_m;
      transform.transform.translation.y = now.y_m;
      transform.transform.rotation = odometry.pose.pose.orientation;
      broadcaster_->sendTransform(transform);
    }
  }

  std::vector<std::string> joints_;
  std::string frame_, child_;
  bool final_only_ = false;
  std::array<double, 2> counts_per_turn_{};
  umbmark_odometer odometer_{};
  rclcpp::Time first_;
  bool begun_ = false, told_ = false;
  umbmark_estimate last_{};
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr publisher_;
  rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr subscription_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<OdometryNode>());
  rclcpp::shutdown();
  return 0;
}
