#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""play_recording.py HOLDFAST PACKAGES CONFIGURATION WORK [FRAMES]: the node of ROS 1 on freiburg1_xyz, played by rosbag in real time
through a roscore, compared with `holdfast run` of the same configuration. Checks topics, transforms and services, and
prints what it measured. HOLDFAST: the program; PACKAGES: folder with the package holdfast_ros; WORK: an empty folder.
Times are compared with the bar only where HOLDFAST_TIMED is set: other work of the machine would decide otherwise."""

import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import threading
import time

SKIPPED = 77
try:
    import numpy
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    from geometry_msgs.msg import PoseWithCovarianceStamped
    from nav_msgs.msg import OccupancyGrid, Odometry, Path
    from sensor_msgs.msg import CameraInfo, PointCloud2
    from std_srvs.srv import SetBool, Trigger
    from tf2_msgs.msg import TFMessage

    import write_bag
except ImportError as error:
    print(f"skipped: {error}; `sh cmake/install_dependencies.sh --ros` installs it on Debian 12")
    sys.exit(SKIPPED)

BAR_LATENCY = 1 / 30  # s
BAR_ANSWERED = 0.99
BAR_DISTANCE = 0.02  # m


def matrix_of(translation, rotation):
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    T = numpy.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = [translation.x, translation.y, translation.z]
    return T


class Listener:
    """Keeps what the node publishes, and when."""

    def __init__(self):
        self.lock = threading.Lock()
        self.arrivals = {}  # stamp [ns] of an image and the time when its camera_info came
        self.poses, self.odometry, self.transforms = {}, {}, {}
        self.latest = {}  # topic and its last message
        for topic in (write_bag.INFO, write_bag.DEPTH_INFO):
            rospy.Subscriber(topic, CameraInfo, self.on_info, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber("/holdfast/pose", PoseWithCovarianceStamped, self.on_pose, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber("/holdfast/odometry", Odometry, self.on_odometry, queue_size=100)
        rospy.Subscriber("/tf", TFMessage, self.on_transforms, queue_size=100)
        for topic, kind in {
            "/map": OccupancyGrid,
            "/holdfast/path": Path,
            "/holdfast/points": PointCloud2,
            "/holdfast/obstacles": PointCloud2,
            "/holdfast/octomap": rospy.AnyMsg,
            "/diagnostics": DiagnosticArray,
            "/tf_static": TFMessage,
        }.items():
            rospy.Subscriber(topic, kind, lambda message, topic=topic: self.latest.__setitem__(topic, message))

    def on_info(self, message):
        with self.lock:
            self.arrivals.setdefault(message.header.stamp.to_nsec(), time.monotonic())
            self.last_arrival = time.monotonic()

    def on_pose(self, message):
        with self.lock:
            self.poses.setdefault(message.header.stamp.to_nsec(), (time.monotonic(), message))

    def on_odometry(self, message):
        with self.lock:
            self.odometry[message.header.stamp.to_nsec()] = message

    def on_transforms(self, message):
        with self.lock:
            for t in message.transforms:
                key = (t.header.frame_id, t.child_frame_id)
                T = matrix_of(t.transform.translation, t.transform.rotation)
                self.transforms.setdefault(key, {})[t.header.stamp.to_nsec()] = T

    def wait_for_end(self, silence=3.0, most=300.0):
        """Until images came and then none for some time."""
        end = time.monotonic() + most
        while time.monotonic() < end:
            with self.lock:
                if self.arrivals and time.monotonic() - self.last_arrival > silence:
                    return
            time.sleep(0.2)
        raise AssertionError("the bag did not end")

    def wait_for_poses(self, silence=3.0, most=60.0):
        """Until poses came and then none for some time."""
        end = time.monotonic() + most
        while time.monotonic() < end:
            with self.lock:
                if self.poses and time.monotonic() - max(came for came, _ in self.poses.values()) > silence:
                    return
            time.sleep(0.2)

    def clear(self):
        with self.lock:
            self.arrivals, self.poses, self.odometry, self.transforms = {}, {}, {}, {}

    def diagnosis(self):
        return {value.key: value.value for value in self.latest["/diagnostics"].status[0].values}


class Checks:
    def __init__(self):
        self.failures = []

    def expect(self, holds, text):
        print(("ok    " if holds else "FAILED ") + text, flush=True)
        if not holds:
            self.failures.append(text)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def start(command, log, **options):
    stream = open(log, "w")
    return subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, **options)


def stop(process):
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()


def read_trajectory(file):
    """Stamps [us] and positions; trajectory files have six decimals."""
    poses = {}
    for line in file.read_text().splitlines():
        if line and not line.startswith("#"):
            numbers = [float(word) for word in line.split()]
            poses[round(numbers[0] * 1e6)] = numpy.array(numbers[1:4])
    return poses


def map_of_world():
    """The camera of a bag without a robot looks along x of base_link."""
    T = numpy.eye(4)
    T[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    return T


def check_transforms(checks, listener, expected):
    """Positions of base_link in map by tf, against those of the program."""
    in_odom = listener.transforms.get(("odom", "base_link"), {})
    to_odom = listener.transforms.get(("map", "odom"), {})
    common = sorted(stamp for stamp in in_odom if stamp in to_odom and round(stamp / 1000) in expected)
    checks.expect(len(common) > 0.95 * len(expected), f"{len(common)} of {len(expected)} poses have transforms")
    if not common:
        return
    R = map_of_world()[:3, :3]
    distances = [
        numpy.linalg.norm((to_odom[stamp] @ in_odom[stamp])[:3, 3] - R @ expected[round(stamp / 1000)])
        for stamp in common
    ]
    median, most, largest = numpy.percentile(distances, [50, 95, 100])
    checks.expect(
        largest < BAR_DISTANCE,
        f"transforms against `holdfast run`: median {median:.4f} m, 95 % {most:.4f} m, largest {largest:.4f} m",
    )
    steps = [
        numpy.linalg.norm((numpy.linalg.inv(in_odom[a]) @ in_odom[b])[:3, 3]) / ((b - a) * 1e-9)
        for a, b in zip(common, common[1:])
        if b - a < 50e6
    ]
    checks.expect(max(steps) < 2.0, f"odom to base_link is continuous: at most {max(steps):.2f} m/s")


def check_times(checks, listener, frames, is_timed):
    """Answers within the period of the camera, by the clock of this process: from the camera_info that came with the
    images to the pose."""
    latencies = []
    stamps = numpy.array(sorted(listener.arrivals))
    for stamp, (answered, _) in listener.poses.items():
        # Its own and that of the depth image, the nearest other one. A pose may overtake them on its way to this process.
        near = sorted(stamps[numpy.abs(stamps - stamp) < 20e6], key=lambda other: abs(other - stamp))[:2]
        came = max((listener.arrivals[other] for other in near), default=answered)
        latencies.append(max(0.0, answered - came))
    frames = max(frames, len(latencies))  # the node may pair a colour image that `holdfast run` leaves out
    share = sum(latency <= BAR_LATENCY for latency in latencies) / frames
    text = (
        f"{share:.1%} of {frames} frames have a pose within {1e3 * BAR_LATENCY:.0f} ms (median "
        f"{1e3 * numpy.median(latencies):.1f} ms, 99 % {1e3 * numpy.percentile(latencies, 99):.1f} ms; load "
        f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} processors)"
    )
    if is_timed:
        checks.expect(share >= BAR_ANSWERED, text)
    else:
        print("      " + text, flush=True)


def check_topics(checks, listener):
    latest = listener.latest
    grid = latest.get("/map")
    checks.expect(grid is not None, "the occupancy grid is published")
    if grid is not None:
        cells = numpy.array(grid.data)
        checks.expect(
            len(cells) == grid.info.width * grid.info.height and (cells == 0).any() and (cells == 100).any(),
            f"grid of {grid.info.width} x {grid.info.height} cells of {grid.info.resolution:.2f} m in {grid.header.frame_id}: "
            f"{(cells == 0).sum()} free, {(cells == 100).sum()} occupied",
        )
    octomap = latest.get("/holdfast/octomap")
    checks.expect(
        octomap is not None and octomap._connection_header["type"] == "octomap_msgs/Octomap",
        f"octomap of {len(octomap._buff) if octomap else 0} bytes, type octomap_msgs/Octomap",
    )
    points, path = latest.get("/holdfast/points"), latest.get("/holdfast/path")
    checks.expect(points is not None and points.width > 1000, f"{points.width if points else 0} static points")
    checks.expect(path is not None and len(path.poses) > 5, f"path of {len(path.poses) if path else 0} keyframes")
    checks.expect("/holdfast/obstacles" in latest, "obstacles are published")
    pose = list(listener.poses.values())[-1][1].pose
    deviation = numpy.sqrt(max(pose.covariance[0], pose.covariance[7], pose.covariance[14]))
    checks.expect(0 < deviation < 0.1, f"standard deviation of the last position {1e3 * deviation:.1f} mm")
    statics = {t.child_frame_id for t in latest["/tf_static"].transforms}
    checks.expect(bool(statics), f"static transforms to {sorted(statics)}")
    status = latest["/diagnostics"].status[0]
    print(f"      diagnostics: {status.message}; {listener.diagnosis()}", flush=True)


def call(name, kind=Trigger, *arguments):
    rospy.wait_for_service(name, 10)
    return rospy.ServiceProxy(name, kind)(*arguments)


def check_services(checks, listener, holdfast, work, bag, expected):
    map_file = work / "map.hfm"
    refused = call("/holdfast/load_map")
    checks.expect(not refused.success, f"a map that is not there is refused: {refused.message}")
    saved = call("/holdfast/save_map")
    checks.expect(bool(saved.success) and map_file.exists(), f"save_map: {saved.message}")
    info = subprocess.run([holdfast, "map", "info", str(map_file)], capture_output=True, text=True)
    checks.expect(info.returncode == 0, "`holdfast map info` reads the map")
    localise = call("/holdfast/localise")
    checks.expect(bool(localise.success), f"localise: {localise.message}")
    listener.clear()
    player = ["rosbag", "play", "--clock", "--quiet", "--duration=5", "--wait-for-subscribers", str(bag)]
    player += ["--topics", write_bag.COLOUR, write_bag.DEPTH, write_bag.INFO]
    subprocess.run(player, check=True, stdout=subprocess.DEVNULL)
    time.sleep(2)
    R = map_of_world()[:3, :3]
    with listener.lock:
        found = dict(listener.poses)
    distances = []
    for stamp, (_, message) in found.items():
        p = message.pose.pose.position
        if round(stamp / 1000) in expected:
            distances.append(numpy.linalg.norm([p.x, p.y, p.z] - R @ expected[round(stamp / 1000)]))
    checks.expect(
        len(distances) > 50 and numpy.percentile(distances, 95) < BAR_DISTANCE,
        f"localised in the saved map: {len(distances)} poses, 95 % within "
        f"{numpy.percentile(distances, 95) if distances else numpy.inf:.4f} m of the first run",
    )
    checks.expect(bool(call("/holdfast/pause", SetBool, True).success), "pause")
    time.sleep(1.5)
    checks.expect(listener.latest["/diagnostics"].status[0].message == "paused", "diagnostics say paused")
    call("/holdfast/pause", SetBool, False)
    checks.expect(bool(call("/holdfast/reset").success), "reset")


def launch_node(bag, work, name, *arguments):
    command = ["roslaunch", "holdfast_ros", "holdfast.launch", f"bag:={bag}", f"colour:={write_bag.COLOUR}", f"depth:={write_bag.DEPTH}"]
    command += [f"camera_info:={write_bag.INFO}", f"imu:={write_bag.DEPTH_INFO}_none", "set:=['camera=tum_fr1']"]
    command += [f"map_file:={work / 'map.hfm'}", f"params:={work / 'params.yaml'}", *arguments]
    return start(command, work / f"{name}.log")


def check_compressed(checks, listener, recording, work, expected, frames=90):
    """The same, with images that image_transport compressed: a new node, whose map begins with the first frame."""
    bag = work / "compressed.bag"
    write_bag.write_bag(recording, bag, frames, is_compressed=True)
    listener.clear()
    launch = launch_node(bag, work, "launch_compressed", "compressed:=true")
    try:
        listener.wait_for_poses()
    finally:
        stop(launch)
        bag.unlink()
    R = map_of_world()[:3, :3]
    distances = []
    for stamp, (_, message) in listener.poses.items():
        p = message.pose.pose.position
        if round(stamp / 1000) in expected:
            distances.append(numpy.linalg.norm([p.x, p.y, p.z] - R @ expected[round(stamp / 1000)]))
    checks.expect(
        len(distances) > 0.8 * frames and max(distances) < BAR_DISTANCE,
        f"compressed images: {len(distances)} poses of {frames} frames, at most {max(distances, default=numpy.inf):.4f} m from "
        "`holdfast run`",
    )


def run(holdfast, packages, configuration, work, frames):
    recording = pathlib.Path(os.environ["HOLDFAST_DATA"]) / "tum_fr1_xyz"
    bag = work / "fr1_xyz.bag"
    whole = write_bag.write_bag(recording, bag, frames)
    print(f"bag of {whole} frames, {bag.stat().st_size / 1e6:.0f} MB", flush=True)
    command = [holdfast, "run", configuration, "--output", str(work / "out"), "--quiet", "--set", "camera=tum_fr1"]
    command += ["--set", f"source.tum.path={recording}", "--set", "surface.enabled=true", "--set", "run.late_frames=drop"]
    if frames:
        command += ["--set", f"source.tum.frames={frames}"]
    subprocess.run(command, check=True)
    expected = read_trajectory(work / "out" / "trajectory.txt")
    if frames:
        expected = dict(sorted(expected.items())[:frames])

    port = free_port()
    # Set before rospy connects: it reads them when it starts.
    os.environ.update(
        ROS_MASTER_URI=f"http://127.0.0.1:{port}",
        ROS_HOSTNAME="127.0.0.1",
        ROS_HOME=str(work / "ros"),
        ROS_LOG_DIR=str(work / "ros" / "log"),
        ROS_PACKAGE_PATH=f"{packages}:/usr/share",
        ROSCONSOLE_STDOUT_LINE_BUFFERED="1",
    )
    checks = Checks()
    core = start(["roscore", "-p", str(port)], work / "roscore.log")
    launch = None
    try:
        for _ in range(100):
            if subprocess.run(["rosparam", "list"], capture_output=True).returncode == 0:
                break
            time.sleep(0.2)
        rospy.init_node("checker", disable_signals=True)
        listener = Listener()
        launch = launch_node(bag, work, "launch")
        listener.wait_for_end()
        time.sleep(2)  # the last grid
        check_transforms(checks, listener, expected)
        check_times(checks, listener, whole, "HOLDFAST_TIMED" in os.environ)
        answered = int(listener.diagnosis()["answered"])
        print(f"      {answered / whole:.1%} of the frames were answered", flush=True)
        check_topics(checks, listener)
        check_services(checks, listener, holdfast, work, bag, expected)
        checks.expect(launch.poll() is None, "the node still runs")
        stop(launch)
        check_compressed(checks, listener, recording, work, expected)
    finally:
        if launch:
            stop(launch)
        stop(core)
        bag.unlink()
    if checks.failures:
        print((work / "launch.log").read_text()[-4000:])
    return 1 if checks.failures else 0


def main():
    if not shutil.which("roscore") or not shutil.which("rosbag"):
        print("skipped: roscore or rosbag is missing; `sh cmake/install_dependencies.sh --ros` installs it on Debian 12")
        return SKIPPED
    if "HOLDFAST_DATA" not in os.environ:
        print("skipped: HOLDFAST_DATA is not set")
        return SKIPPED
    holdfast, packages, configuration, work = sys.argv[1:5]
    work = pathlib.Path(work).resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    (work / "params.yaml").write_text(json.dumps({"depth_factor": 5000.0}))
    return run(holdfast, packages, configuration, work, int(sys.argv[5]) if len(sys.argv) > 5 else None)


if __name__ == "__main__":
    sys.exit(main())
