# SPDX-License-Identifier: BSD-3-Clause
"""Starts the node on the topics of a camera; the defaults are those of a RealSense camera with aligned depth."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

TOPICS = {
    "colour": "/camera/camera/color/image_raw",
    "depth": "/camera/camera/aligned_depth_to_color/image_raw",
    "camera_info": "/camera/camera/color/camera_info",
}


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value=topic) for name, topic in TOPICS.items()]
    arguments.append(DeclareLaunchArgument("segment_people", default_value="true"))
    node = Node(
        package="holdfast_ros",
        executable="holdfast_node",
        name="holdfast",
        output="screen",
        parameters=[{"segment_people": LaunchConfiguration("segment_people")}],
        remappings=[(name, LaunchConfiguration(name)) for name in TOPICS],
    )
    return LaunchDescription([*arguments, node])
