# SPDX-License-Identifier: BSD-3-Clause
"""Starts the component on the topics of a camera, or of a bag; the defaults are those of a RealSense camera with
aligned depth. README.md lists the parameters of the node; a file sets them: params:=FILE.yaml"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode
from launch_ros.substitutions import FindPackageShare

TOPICS = {
    "colour": "/camera/camera/color/image_raw",
    "depth": "/camera/camera/aligned_depth_to_color/image_raw",
    "camera_info": "/camera/camera/color/camera_info",
    "imu": "/camera/camera/imu",
}
COMPRESSED = {"colour": "/compressed", "depth": "/compressedDepth"}


def generate_launch_description():
    share = FindPackageShare("holdfast_ros")
    arguments = {
        **TOPICS,
        "configuration": PathJoinSubstitution([share, "config", "robot.yaml"]),
        "set": "['']",  # settings of the pipeline, such as "['camera=tum_fr1']"
        "compressed": "false",  # colour/compressed and depth/compressedDepth in place of raw images
        "map_file": "",
        "start": "new",
        "bag": "",
        "rviz": "false",
    }
    plays = PythonExpression(["'", LaunchConfiguration("bag"), "' != ''"])
    component = ComposableNode(
        package="holdfast_ros",
        plugin="holdfast_ros::HoldfastNode",
        name="holdfast",
        parameters=[
            {name: LaunchConfiguration(name) for name in ("configuration", "set", "compressed", "map_file", "start")},
            {"use_sim_time": plays},
        ],
        remappings=[(name, LaunchConfiguration(name)) for name in TOPICS]
        + [(name + transport, [LaunchConfiguration(name), transport]) for name, transport in COMPRESSED.items()]
        + [("~/map", "/map")],
        # Images of a camera in the same container are handed over without a copy.
        extra_arguments=[{"use_intra_process_comms": True}],
    )
    container = ComposableNodeContainer(
        package="rclcpp_components",
        executable="component_container_mt",
        name="holdfast_container",
        namespace="",
        composable_node_descriptions=[component],
        output="screen",
    )
    bag = ExecuteProcess(
        cmd=["ros2", "bag", "play", LaunchConfiguration("bag"), "--clock", "--delay", "3"], condition=IfCondition(plays)
    )
    rviz = Node(
        package="rviz2",
        executable="rviz2",
        arguments=["-d", PathJoinSubstitution([share, "rviz", "holdfast.rviz"])],
        condition=IfCondition(LaunchConfiguration("rviz")),
    )
    declared = [DeclareLaunchArgument(name, default_value=value) for name, value in arguments.items()]
    return LaunchDescription([*declared, container, bag, rviz])
