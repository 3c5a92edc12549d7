#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the viewer's page costs in a headless Chromium without a graphics card.

  benchmarks/viewer_page.py                     draws a map of 100,000 points: processor time per picture, pictures per second
  benchmarks/viewer_page.py --run ARGUMENTS     starts `holdfast run ARGUMENTS --view` as well: seconds from its start to the
                                                first picture in a browser that is open already
  benchmarks/viewer_page.py --cost 4 --run ARGUMENTS
                                                four interleaved runs each without the viewer, with it, and with a browser in
                                                addition: time of tracking, processor time of the thread that tracks, of the
                                                viewer's, and of the browser, loading of the page included

Processor times do not depend on what else the machine does; pictures per second and seconds do, so the load is printed, too.
"""

import argparse
import fcntl
import json
import os
import pathlib
import re
import select
import shutil
import signal
import statistics
import subprocess
import tempfile
import threading
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
PAGE_FOLDERS = [SOURCE / "modules/viewer/page", SOURCE / "modules/evaluation/page"]

# A room of 6 x 6 x 3 m, whose walls are points, and a path in it.
ROOM = """testModel((m) => {
  let seed = 1;
  const random = () => (seed = seed * 16807 % 2147483647) / 2147483647;
  const count = 100000, half = [3, 3, 1.5], width = m.points.width, values = new Float32Array(width * count);
  for (let i = 0; i < count; ++i) {
    const wall = Math.floor(6 * random()), place = half.map((h) => h * (2 * random() - 1));
    place[wall >> 1] = (wall & 1 ? 1 : -1) * half[wall >> 1];
    values.set([...place, 4 * random() - 1.5, 255], width * i);
  }
  m.points.reserve(count);
  m.points.data.set(values);
  m.points.count = count;
  for (let i = 0; i < 600; ++i) {
    m.stamps.append([i / 30]);
    m.path.append([Math.cos(i / 100), Math.sin(i / 100), 0.1, 0, 0, 0, 1, 2, NaN]);
  }
  m.state = {finished: true};
  m.changed.add('all');
})"""
DRAW = """(() => {
  for (let i = 0; i < %d; ++i) {
    holdfastViewer.view.rotate(0.05, 0);
    holdfastViewer.pixel(0, 0);
  }
})()"""


class Browser:
    """A headless Chromium, told what to do through a pair of pipes."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="holdfast_page_")
        to_browser, self.output = os.pipe()
        self.input, from_browser = os.pipe()

        def connect():
            os.setpgid(0, 0)
            ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 20) for end in (to_browser, from_browser)]
            for end, place in zip(ends, (3, 4)):
                os.dup2(end, place)

        program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        if program is None:
            raise SystemExit("no chromium, chromium-browser or google-chrome in PATH")
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                   "--disable-dev-shm-usage", "--disable-background-networking", "--remote-debugging-pipe",
                   "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--window-size=1280,900",
                   f"--user-data-dir={self.profile}"]
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen([program, *options], preexec_fn=connect, close_fds=False, stdin=quiet, stdout=quiet,
                                        stderr=quiet)
        self.received, self.last, self.session = b"", 0, None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)

    def call(self, method, **parameters):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.output, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self.received:
                if not select.select([self.input], [], [], 120)[0]:
                    raise SystemExit("the browser does not answer")
                self.received += os.read(self.input, 1 << 20)
            text, self.received = self.received.split(b"\0", 1)
            answer = json.loads(text)
            if answer.get("id") == self.last:
                return answer["result"]

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in answer:
            raise SystemExit(json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait_for(self, expression):
        while not self.evaluate(f"Boolean({expression})"):
            time.sleep(0.02)

    def processor_seconds(self):
        total = 0
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if os.getpgid(int(folder.name)) == self.process.pid:
                    total += processor_seconds(folder.name)
            except (OSError, ValueError):
                pass  # gone in the meantime
        return total

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        shutil.rmtree(self.profile, ignore_errors=True)


def processor_seconds(process):
    fields = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class ThreadTimes(threading.Thread):
    """Processor seconds of the threads of a process by name, as far as they were seen before its end."""

    def __init__(self, process):
        super().__init__(daemon=True)
        self.process, self.seconds = process, {}
        self.start()

    def run(self):
        while self.process.poll() is None:
            self.look()
            time.sleep(0.02)

    def look(self):
        for folder in pathlib.Path(f"/proc/{self.process.pid}/task").glob("*"):
            try:
                name = "tracking" if folder.name == str(self.process.pid) else (folder / "comm").read_text().strip()
                self.seconds[name] = processor_seconds(f"{self.process.pid}/task/{folder.name}")
            except OSError:
                pass  # gone in the meantime


def page_without_server(folder):
    """The page with a socket that never answers, and a door to its model."""

    def part(match):
        return next(place / match[1] for place in PAGE_FOLDERS if (place / match[1]).exists()).read_text()

    page = re.sub(r"\{\{([\w.]+)\}\}", part, (PAGE_FOLDERS[0] / "viewer.html").read_text())
    page = page.replace("new WebSocket(", "new (class { addEventListener() {} send() {} })(")
    page = page.replace("globalThis.holdfastViewer =", "globalThis.testModel = (f) => f(model);\nglobalThis.holdfastViewer =")
    file = pathlib.Path(folder) / "page.html"
    file.write_text(page)
    return file


def measure_drawing(browser, folder):
    browser.call("Page.navigate", url=page_without_server(folder).as_uri())
    browser.wait_for("globalThis.testModel")
    browser.evaluate(ROOM)
    time.sleep(3)  # until everything is compiled and the view rests
    browser.evaluate(DRAW % 10)
    count, before = 30, browser.processor_seconds()
    browser.evaluate(DRAW % count)
    print(f"processor time per picture of all points  {1e3 * (browser.processor_seconds() - before) / count:.1f} ms")
    browser.evaluate("holdfastViewer.spin(true)")
    time.sleep(6)
    print(f"pictures per second while turning         {browser.evaluate('holdfastViewer.framesPerSecond()'):.1f}")
    browser.evaluate("holdfastViewer.spin(false)")
    time.sleep(3)
    before = browser.processor_seconds()
    time.sleep(5)
    print(f"processor time at rest                    {1e3 * (browser.processor_seconds() - before) / 5:.0f} ms per second")


def measure_first_picture(browser, program, arguments):
    begin = time.monotonic()
    run = subprocess.Popen([program, "run", *arguments, "--view"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        for line in run.stdout:
            if found := re.search(r"http://\S+token=\w+", line):
                break
        else:
            raise SystemExit("the program printed no address")
        served = time.monotonic() - begin
        browser.call("Page.navigate", url=found[0])
        browser.wait_for("globalThis.holdfastViewer && document.getElementById('picture').width > 300")
        print(f"address printed after                     {served:.2f} s")
        print(f"first picture after                       {time.monotonic() - begin:.2f} s, "
              f"{processor_seconds(run.pid):.2f} s of processor time of the program")
    finally:
        run.kill()
        run.wait()


def run_once(program, arguments, folder, browser=None, view=False):
    """Seconds of tracking, of a frame in the median and of the run; processor seconds of the thread that tracks, of the
    viewer's, and of the browser meanwhile."""
    command = [program, "run", *arguments, "--output", folder + "/out", "--overwrite"]
    if view:
        command += ["--set", "observers=[{viewer: {wait: %s}}]" % ("true" if browser else "false"), "--view"]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    before = browser_time = 0.0
    threads = ThreadTimes(run)
    try:
        for line in run.stdout:
            found = re.search(r"http://\S+token=\w+", line)
            if found and browser and not before:
                before = browser.processor_seconds()
                browser.call("Page.navigate", url=found[0])
            if "until Ctrl-C" in line:
                break
        if browser:
            browser_time = browser.processor_seconds() - before
        if view:
            threads.look()
            run.send_signal(signal.SIGINT)
        run.stdout.read()
        run.wait()
        if browser:
            browser.call("Page.navigate", url="about:blank")
    finally:
        run.kill()
        run.wait()
    record = json.loads((pathlib.Path(folder) / "out/run.json").read_text())
    return (record["tracking"]["total_s"], record["tracking"]["median_s"], record["total_s"], threads.seconds["tracking"],
            threads.seconds.get("viewer", 0.0), browser_time)


def measure_cost(browser, program, arguments, folder, count):
    kinds = {"without the viewer": (None, False), "with it": (None, True), "and with a browser": (browser, True)}
    found = {name: [] for name in kinds}
    for _ in range(count):
        for name, (watching, view) in kinds.items():
            found[name].append(run_once(program, arguments, folder, watching, view))
    print(f"medians of {count} runs     tracking [s]  a frame [ms]  run [s]  processor: tracking's thread [s]  viewer's [s]  browser [s]")
    for name, rows in found.items():
        tracking, frame, whole, own, viewer, other = (statistics.median(column) for column in zip(*rows))
        print(f"{name:22} {tracking:12.2f} {1e3 * frame:13.2f} {whole:8.2f} {own:32.2f} {viewer:13.2f} {other:12.2f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=SOURCE / "build/bin/holdfast")
    parser.add_argument("--cost", type=int, default=0, metavar="RUNS")
    parser.add_argument("--run", nargs=argparse.REMAINDER)
    chosen = parser.parse_args()
    opened = Browser()
    try:
        with tempfile.TemporaryDirectory() as scratch:
            if chosen.cost and chosen.run:
                measure_cost(opened, chosen.program, chosen.run, scratch, chosen.cost)
            else:
                measure_drawing(opened, scratch)
            if chosen.run and not chosen.cost:
                measure_first_picture(opened, chosen.program, [*chosen.run, "--output", scratch + "/out"])
    finally:
        opened.close()
    print(f"load of the machine                       {' '.join(map(str, os.getloadavg()))} on {os.cpu_count()} cores")
