#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""write_bag.py RECORDING BAG [FRAMES]: a recording in TUM layout as a bag of ROS 1, by ROS' own library: every image with
its own time stamp, as the camera's driver published it."""

import pathlib
import sys

import cv2
import genpy
import rosbag
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

COLOUR, DEPTH, INFO = "/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"
# Small messages beside the depth images, which say when these were published.
DEPTH_INFO = "/camera/depth/camera_info"
FRAME = "/openni_rgb_optical_frame"


def read_list(file):
    """Rows (time stamp as text, file) of rgb.txt and depth.txt."""
    rows = [line.split() for line in file.read_text().splitlines() if line.strip() and not line.startswith("#")]
    return [(row[0], row[1]) for row in rows]


def time_of(text):
    seconds, fraction = text.split(".")
    return genpy.Time(int(seconds), int(fraction.ljust(9, "0")[:9]))


def image_message(pixels, encoding, stamp):
    message = Image()
    message.header.stamp, message.header.frame_id = stamp, FRAME
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.step = encoding, pixels.strides[0]
    message.data = pixels.tobytes()
    return message


def compressed_message(topic, file, stamp):
    """The bytes of the PNG file, as image_transport publishes images: depth after 12 bytes of settings."""
    message = CompressedImage()
    message.header.stamp, message.header.frame_id = stamp, FRAME
    is_colour = topic == COLOUR
    message.format = "rgb8; png compressed bgr8" if is_colour else "16UC1; compressedDepth png"
    message.data = (b"" if is_colour else bytes(12)) + file.read_bytes()
    return message


def info_message(stamp):
    """The default of the driver, as in the bags of TUM."""
    message = CameraInfo()
    message.header.stamp, message.header.frame_id = stamp, FRAME
    message.width, message.height, message.distortion_model = 640, 480, "plumb_bob"
    message.D = [0.0] * 5
    message.K = [525.0, 0, 319.5, 0, 525.0, 239.5, 0, 0, 1]
    message.R = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
    message.P = [525.0, 0, 319.5, 0, 0, 525.0, 239.5, 0, 0, 0, 1, 0]
    return message


def count_frames(colours, depths, most=0.02):
    pairs = sorted((abs(a - b), a, b) for a in colours for b in depths if abs(a - b) < most)
    used = set()
    for _, a, b in pairs:
        if ("colour", a) not in used and ("depth", b) not in used:
            used |= {("colour", a), ("depth", b)}
    return len(used) // 2


def write_bag(recording, bag_file, frames=None, is_compressed=False):
    """Colour as rgb8 and depth as 16UC1 with 5000 for a metre, or both compressed. Returns the number of frames, by the rule of TUM: images are
    paired one to one, nearest first, within 20 ms."""
    colours, depths = read_list(recording / "rgb.txt")[:frames], read_list(recording / "depth.txt")
    last = float(colours[-1][0])
    images = [(float(stamp), stamp, name, COLOUR) for stamp, name in colours]
    images += [(float(stamp), stamp, name, DEPTH) for stamp, name in depths if float(stamp) < last + 0.02]
    with rosbag.Bag(str(bag_file), "w") as bag:
        for _, text, name, topic in sorted(images):
            stamp = time_of(text)
            bag.write(INFO if topic == COLOUR else DEPTH_INFO, info_message(stamp), stamp)
            if is_compressed:
                transport = "/compressed" if topic == COLOUR else "/compressedDepth"
                bag.write(topic + transport, compressed_message(topic, recording / name, stamp), stamp)
                continue
            pixels = cv2.imread(str(recording / name), cv2.IMREAD_COLOR if topic == COLOUR else cv2.IMREAD_UNCHANGED)
            if topic == COLOUR:
                pixels = cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB)
            bag.write(topic, image_message(pixels, "rgb8" if topic == COLOUR else "16UC1", stamp), stamp)
    return count_frames([float(stamp) for stamp, _ in colours], [float(stamp) for stamp, _ in depths])


if __name__ == "__main__":
    print(write_bag(pathlib.Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else None))
