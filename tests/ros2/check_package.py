#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_package.py FOLDER: the parts of a ROS 2 package agree: package.xml, CMakeLists.txt, includes, launch file."""

import ast
import pathlib
import re
import sys
import xml.etree.ElementTree

LONGEST_NODE = 150  # lines: an example is read as a whole


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
    source = folder / "src" / "holdfast_node.cpp"
    lines = source.read_text().splitlines()
    if len(lines) > LONGEST_NODE:
        problems.append(f"{source.name} has {len(lines)} lines; expected at most {LONGEST_NODE}")
    included = {match.group(1) for line in lines if (match := re.match(r"#include <(\w+)/", line))}
    if included != depends:
        problems.append(f"{source.name} includes {sorted(included)}; package.xml depends on {sorted(depends)}")
    launch = folder / "launch" / "holdfast.launch.py"
    tree = ast.parse(launch.read_text())
    values = {k.arg: k.value.value for k in ast.walk(tree) if isinstance(k, ast.keyword) and isinstance(k.value, ast.Constant)}
    if values.get("package") != name or f"add_executable({values.get('executable')} " not in build:
        problems.append(f"{launch.name} starts {values.get('package')}/{values.get('executable')}, which is not built")
    topics = set(re.findall(r'subscribe\(this, "(\w+)"', "\n".join(lines)))
    remapped = set(re.findall(r'^    "(\w+)": "/', launch.read_text(), re.MULTILINE))
    if topics != remapped:
        problems.append(f"{launch.name} remaps {sorted(remapped)}; the node subscribes {sorted(topics)}")
    return problems


if __name__ == "__main__":
    found = check(pathlib.Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
