#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_package.py FOLDER: the parts of a ROS 2 package agree: package.xml, CMakeLists.txt, includes, launch file."""

import ast
import pathlib
import re
import sys
import xml.etree.ElementTree

def check(folder):
    problems = []
    root = xml.etree.ElementTree.parse(folder / "package.xml").getroot()
    name = root.findtext("name")
    depends = {element.text for element in root.findall("depend")}
    build = (folder / "CMakeLists.txt").read_text()
    if f"project({name} " not in build:
        problems.append(f"CMakeLists.txt: the project is not '{name}', as package.xml says")
    packages = re.search(r"set\(ros_packages ([^)]*)\)", build).group(1).split()
    if set(packages) != depends:
        problems.append(f"CMakeLists.txt looks for {sorted(packages)}; package.xml depends on {sorted(depends)}")
    sources = sorted((folder / "src").iterdir())
    built = set(re.findall(r"src/(\w+\.cpp)", build))
    if built != {source.name for source in sources if source.suffix == ".cpp"}:
        problems.append(f"CMakeLists.txt builds {sorted(built)}; src has other files")
    text = "\n".join(source.read_text() for source in sources)
    # rclcpp_components is included for its macro; messages and libraries are named after their packages.
    included = set(re.findall(r"^#include <(\w+)/", text, re.MULTILINE)) - {"builtin_interfaces", "std_msgs"}
    if included != depends:
        problems.append(f"the sources include {sorted(included)}; package.xml depends on {sorted(depends)}")
    launch = folder / "launch" / "holdfast.launch.py"
    written = launch.read_text()
    ast.parse(written)
    plugin = re.search(r'plugin="([\w:]+)"', written).group(1)
    if f'package="{name}"' not in written or f"PLUGIN {plugin} " not in build or f"REGISTER_NODE({plugin})" not in text:
        problems.append(f"{launch.name} loads {plugin}, which is not registered, or not of the package {name}")
    compressed = set(re.findall(r'listen<[\w:]*CompressedImage>\("([\w/]+)"', text)) - {"right/compressed"}
    shown = {a + b for a, b in re.findall(r'"(\w+)": "(/compressed\w*)"', written)}
    in_ros1 = (folder.parent / "ros1/launch/holdfast.launch").read_text()
    in_ros1 = set(re.findall(r'<remap from="~([\w]+/[\w]+)" to="\$\(arg \w+\)/\w+"/>', in_ros1))
    if not compressed or shown != compressed or in_ros1 != compressed:
        problems.append(f"launch files remap {sorted(shown)} and {sorted(in_ros1)}; the nodes subscribe {sorted(compressed)}")
    topics = set(re.findall(r'listen<[\w:]+>\("(\w+)"', text)) - {"right", "right_camera_info"}
    remapped = set(re.findall(r'^    "(\w+)": "/', written, re.MULTILINE))
    if topics != remapped:
        problems.append(f"{launch.name} remaps {sorted(remapped)}; the component subscribes {sorted(topics)}")
    names = folder.parent.parent / "include/holdfast/bridge/node_parameters.hpp"
    parameters = set(re.findall(r'use\("(\w+)"', names.read_text()))
    given = set(re.search(r"for name in \(([^)]*)\)", written).group(1).replace('"', "").split(", "))
    if not given <= parameters:
        problems.append(f"{launch.name} sets {sorted(given - parameters)}, which the component does not declare")
    documented = (folder.parent / "ros1" / "README.md").read_text()
    for parameter in sorted(parameters):
        if f"`{parameter}`" not in documented:
            problems.append(f"integrations/ros1/README.md does not name the parameter '{parameter}'")
    return problems


if __name__ == "__main__":
    found = check(pathlib.Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
