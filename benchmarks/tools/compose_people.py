#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Put moving people into a static RGB-D sequence, with exact ground truth.

Reads a TUM-layout sequence (rgb.txt, depth.txt, groundtruth.txt) recorded by a
moving camera in a static room, and a folder of person photographs with masks
(Penn-Fudan layout), and writes a new TUM-layout sequence in which people walk
through that room.  Each person is an upright textured sheet with relief that
moves through the world; it is drawn into every colour and every depth image
from the ground-truth camera pose at that image's own time stamp, hidden
wherever the real depth is nearer.  Camera motion, image noise, exposure, blur
and depth holes of the room stay those of the real recording; groundtruth.txt
is copied unchanged.

Output: rgb/*.jpg|png, depth/*.png (16 bit, units as read, 5000 = 1 m for TUM), mask/*.png (8 bit,
0 = static, k = person k; name = the colour image's), rgb.txt, depth.txt,
mask.txt, groundtruth.txt, scene.json (everything that was drawn, by seed).

People come from a folder in Penn-Fudan layout: PNGImages/NAME.png|jpg and PedMasks/NAME_mask.png (0 = background, k = person k).

Needs: Debian's python3 with python3-numpy and python3-opencv.
"""
import argparse, json, os, shutil, sys
import cv2
import numpy as np

CAMERAS = {  # fx fy cx cy, distortion k1 k2 p1 p2 k3 (TUM RGB-D calibration page)
    "fr1": (517.306408, 516.469215, 318.643040, 255.313989,
            [0.262383, -0.953104, -0.005358, 0.002628, 1.163314]),
    "fr2": (520.908620, 521.007327, 325.141442, 249.701764,
            [0.231222, -0.784899, -0.003257, -0.000105, 0.917205]),
    "fr3": (535.4, 539.2, 320.1, 247.6, [0, 0, 0, 0, 0]),
    "7scenes": (585.0, 585.0, 320.0, 240.0, [0, 0, 0, 0, 0]),
}


def read_list(path):
    rows = []
    for line in open(path):
        line = line.strip()
        if line and not line.startswith("#"):
            rows.append(line.split())
    return rows


class Trajectory:
    """Camera poses in the world, linearly / spherically interpolated in time."""

    def __init__(self, path):
        rows = np.array([[float(x) for x in r[:8]] for r in read_list(path)])
        self.t, self.p, self.q = rows[:, 0], rows[:, 1:4], rows[:, 4:8]
        self.upright = np.eye(3)                     # turns the file's world so that z points up

    def level_by_camera(self):
        """For worlds that are not levelled: take the mean upward direction of the camera for up."""
        z = -np.mean([self.at(t)[0][:, 1] for t in np.linspace(self.t[0], self.t[-1], 200)], axis=0)
        z /= np.linalg.norm(z)
        x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
        x /= np.linalg.norm(x)
        self.upright = np.stack([x, np.cross(z, x), z])

    def at(self, t):
        if not self.t[0] <= t <= self.t[-1]:
            return None
        i = int(np.clip(np.searchsorted(self.t, t) - 1, 0, len(self.t) - 2))
        a = (t - self.t[i]) / (self.t[i + 1] - self.t[i])
        q0, q1 = self.q[i], self.q[i + 1]
        if np.dot(q0, q1) < 0:
            q1 = -q1
        q = (1 - a) * q0 + a * q1
        x, y, z, w = q / np.linalg.norm(q)
        R = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                      [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                      [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        return self.upright @ R, self.upright @ ((1 - a) * self.p[i] + a * self.p[i + 1])


def occluder(depth, window=41):
    """Depth for hiding people behind: holes take the nearest depth around them, so that nothing shines through."""
    filled = np.where(depth > 0, depth, 99.0).astype(np.float32)
    for _ in range(3):
        filled = np.where(filled < 99, filled, cv2.erode(filled, np.ones((window, window), np.uint8)))
    return filled


def load_people(folder, minimum_height):
    people = []
    masks = os.path.join(folder, "PedMasks")
    for name in sorted(os.listdir(masks)):
        mask = cv2.imread(os.path.join(masks, name), 0)
        stem = os.path.join(folder, "PNGImages", name.replace("_mask.png", ""))
        image = cv2.imread(stem + ".png" if os.path.exists(stem + ".png") else stem + ".jpg")
        if mask is None or image is None:
            continue
        for k in range(1, int(mask.max()) + 1):
            ys, xs = np.where(mask == k)
            if len(ys) == 0:
                continue
            top, bottom, left, right = ys.min(), ys.max() + 1, xs.min(), xs.max() + 1
            touches = left < 3 or right > mask.shape[1] - 3
            if bottom - top < minimum_height or touches:
                continue
            alpha = (mask[top:bottom, left:right] == k).astype(np.uint8)
            alpha = cv2.erode(alpha, np.ones((3, 3), np.uint8))
            people.append((f"{name}:{k}", image[top:bottom, left:right], alpha))
    return people


class Walker:
    """One person: an upright sheet, facing `normal`, walking along `across` or `normal`."""

    def __init__(self, rng, person, frame, spec):
        self.name, image, alpha = person
        self.image = cv2.GaussianBlur(image, (0, 0), 0.6).astype(np.float32) * spec["gain"]
        self.alpha = cv2.GaussianBlur(alpha.astype(np.float32), (0, 0), 0.8)
        inside = cv2.distanceTransform(alpha, cv2.DIST_L2, 5)
        self.relief = 0.14 * np.sqrt(inside / max(inside.max(), 1.0)).astype(np.float32)
        self.height = spec["height"]
        self.scale = image.shape[0] / self.height               # pixels per metre
        self.width = image.shape[1] / self.scale
        self.origin, self.across, self.normal = frame            # world, metres
        self.spec = spec

    def pose(self, t):
        s = self.spec
        w = 2 * np.pi / s["period"]
        phase = w * t + s["phase"]
        swing = s["amplitude"] * np.sin(phase)
        along = self.across if s["mode"] == "across" else self.normal
        centre = self.origin + s["offset"] * self.across - s["distance"] * self.normal + swing * along
        going_right = np.cos(phase) > 0 if s["mode"] == "across" else True
        stride = s["stride"] * np.sin(2 * np.pi * 1.8 * t + s["phase"])
        bob = 0.02 * abs(np.sin(2 * np.pi * 1.8 * t)) if s["stride"] else 0.0
        return centre, going_right, stride, bob

    def draw(self, t, R, p, rays_world):
        """Returns (depth along the optical axis [m], alpha, colour) images, camera at (R, p)."""
        centre, going_right, stride, bob = self.pose(t)
        denominator = rays_world @ self.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            z = ((centre - p) @ self.normal) / denominator        # rays have unit z, so this is depth
        z = np.where((denominator != 0) & (z > 0.25) & (z < 8), z, np.nan).astype(np.float32)
        points = p + rays_world * np.nan_to_num(z, nan=0.0)[..., None]
        side = (points - centre) @ self.across
        up = points[..., 2] - self.spec["floor"] - bob
        below_hip = np.clip(0.52 * self.height - up, 0, None)
        side = side - stride * below_hip * np.where(side > 0, 1.0, -1.0) * 0.5
        u = (side + self.width / 2) * self.scale
        if not going_right:
            u = self.image.shape[1] - 1 - u
        v = (self.height - up) * self.scale
        u = np.where(np.isnan(z), -1, u).astype(np.float32)
        v = np.where(np.isnan(z), -1, v).astype(np.float32)
        zoom = max(1.0, self.scale * float(np.nanmedian(z)) / 520.0) if np.isfinite(z).any() else 1.0
        image = self.image if zoom < 1.5 else cv2.GaussianBlur(self.image, (0, 0), zoom / 2.5)
        colour = cv2.remap(image, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        alpha = cv2.remap(self.alpha, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        relief = cv2.remap(self.relief, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        return np.nan_to_num(z - relief, nan=0.0), alpha, colour


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("sequence"); a.add_argument("people"); a.add_argument("output")
    a.add_argument("--camera", default="fr1", choices=CAMERAS)
    a.add_argument("--seed", type=int, default=1)
    a.add_argument("--count", type=int, default=2, help="number of people")
    a.add_argument("--mode", default="walk", choices=["walk", "still", "mixed"],
                   help="walk: cross the view; still: stand and sway a little; mixed: both")
    a.add_argument("--start", type=int, default=0, help="first colour frame")
    a.add_argument("--frames", type=int, default=0, help="number of colour frames, 0 = all")
    a.add_argument("--distance", type=float, nargs=2, default=(0.9, 1.5), help="metres before the camera")
    a.add_argument("--depth-units", type=float, default=5000.0, help="depth image units per metre, in and out")
    a.add_argument("--up", default="z", choices=["z", "camera"], help="which way is up in groundtruth.txt")
    a.add_argument("--format", default="jpg", choices=["jpg", "png"])
    a = a.parse_args()

    fx, fy, cx, cy, distortion = CAMERAS[a.camera]
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    truth = Trajectory(os.path.join(a.sequence, "groundtruth.txt"))
    if a.up == "camera":
        truth.level_by_camera()
    colour_rows = read_list(os.path.join(a.sequence, "rgb.txt"))[a.start:]
    if a.frames:
        colour_rows = colour_rows[:a.frames]
    first, last = float(colour_rows[0][0]), float(colour_rows[-1][0])
    depth_rows = [r for r in read_list(os.path.join(a.sequence, "depth.txt"))
                  if first - 0.05 <= float(r[0]) <= last + 0.05]
    depth_times = np.array([float(r[0]) for r in depth_rows])

    probe = cv2.imread(os.path.join(a.sequence, colour_rows[0][1]))
    rows, cols = probe.shape[:2]
    grid = np.stack(np.meshgrid(np.arange(cols), np.arange(rows)), -1).reshape(-1, 1, 2).astype(np.float64)
    normalised = cv2.undistortPoints(grid, K, np.array(distortion)).reshape(rows, cols, 2)
    rays = np.dstack([normalised, np.ones((rows, cols))])

    # A frame for the scene: origin under the mean camera, `forward` its mean viewing direction on the floor.
    poses = [truth.at(t) for t in np.linspace(max(first, truth.t[0]), min(last, truth.t[-1]), 50)]
    forward = np.mean([R[:, 2] for R, _ in poses], axis=0); forward[2] = 0; forward /= np.linalg.norm(forward)
    right = np.mean([R[:, 0] for R, _ in poses], axis=0); right[2] = 0; right -= forward * (right @ forward)
    right /= np.linalg.norm(right)
    origin = np.mean([p for _, p in poses], axis=0)
    eye = origin[2]
    origin = np.array([origin[0], origin[1], 0.0])

    rng = np.random.default_rng(a.seed)
    people = load_people(a.people, 280)
    walkers = []
    for k in range(a.count):
        person = people[int(rng.integers(len(people)))]
        still = a.mode == "still" or (a.mode == "mixed" and k % 2 == 1)
        height = float(rng.uniform(1.62, 1.85))
        spec = dict(height=height, floor=float(eye - height + rng.uniform(-0.05, 0.15)),
                    gain=float(rng.uniform(0.75, 1.0)), phase=float(rng.uniform(0, 2 * np.pi)),
                    distance=float(rng.uniform(*a.distance)),
                    offset=float(rng.uniform(-0.3, 0.3)),
                    mode="across" if rng.random() < 0.75 else "along",
                    period=float(rng.uniform(5, 9)), amplitude=float(rng.uniform(0.7, 1.1)),
                    stride=0.35)
        if spec["mode"] == "along":
            spec["amplitude"] = 0.3
        if still:
            spec.update(mode="across", amplitude=0.02, period=3.0, stride=0.0)
        walkers.append(Walker(rng, person, (origin, right, -forward), spec))

    for d in ("rgb", "depth", "mask"):
        os.makedirs(os.path.join(a.output, d), exist_ok=True)
    shutil.copy(os.path.join(a.sequence, "groundtruth.txt"), os.path.join(a.output, "groundtruth.txt"))

    def layers(t):
        pose = truth.at(t)
        if pose is None:
            return []
        R, p = pose
        rays_world = rays @ R.T
        return [(k + 1,) + w.draw(t - first, R, p, rays_world) for k, w in enumerate(walkers)]

    def real_depth(i):
        d = cv2.imread(os.path.join(a.sequence, depth_rows[i][1]), cv2.IMREAD_UNCHANGED)
        return d.astype(np.float32) / a.depth_units

    # The colour camera sees margins that the depth camera never reaches: people have no depth there either.
    reached = np.any([real_depth(i) > 0 for i in range(0, len(depth_rows), max(1, len(depth_rows) // 40))], axis=0)

    covered = []
    with open(os.path.join(a.output, "rgb.txt"), "w") as f, open(os.path.join(a.output, "mask.txt"), "w") as g:
        f.write("# timestamp filename\n"); g.write("# timestamp filename\n")
        for i, (stamp, path) in enumerate(colour_rows):
            t = float(stamp)
            image = cv2.imread(os.path.join(a.sequence, path)).astype(np.float32)
            nearest = occluder(real_depth(int(np.argmin(abs(depth_times - t)))))
            mask = np.zeros((rows, cols), np.uint8)
            for k, z, alpha, colour in layers(t):
                visible = (z > 0) & (z < nearest) & (alpha > 0.02)
                weight = np.where(visible, alpha, 0)[..., None]
                image = image * (1 - weight) + colour * weight
                mask[visible & (alpha > 0.5)] = k
                nearest = np.where(visible & (alpha > 0.5), z, nearest)
            drawn = mask > 0
            noise = rng.normal(0, 2.0, image.shape).astype(np.float32)
            image[drawn] += noise[drawn]
            covered.append(float(drawn.mean()))
            name = f"{stamp}.{a.format}"
            cv2.imwrite(os.path.join(a.output, "rgb", name), np.clip(image, 0, 255).astype(np.uint8),
                        [cv2.IMWRITE_JPEG_QUALITY, 95])
            cv2.imwrite(os.path.join(a.output, "mask", f"{stamp}.png"), mask)
            f.write(f"{stamp} rgb/{name}\n"); g.write(f"{stamp} mask/{stamp}.png\n")
            if sys.stderr.isatty() and i % 20 == 0:
                print(f"\r{i}/{len(colour_rows)}", end="", file=sys.stderr)
    with open(os.path.join(a.output, "depth.txt"), "w") as f:
        f.write("# timestamp filename\n")
        for i, (stamp, _) in enumerate(depth_rows):
            depth = real_depth(i)
            nearest = occluder(depth)
            for _, z, alpha, _ in layers(float(stamp)):
                visible = (z > 0) & (z < nearest) & (alpha > 0.5)
                sigma = 0.0012 + 0.0019 * np.square(np.clip(z - 0.4, 0, None))
                noisy = z + rng.normal(0, 1, z.shape).astype(np.float32) * sigma
                edge = cv2.morphologyEx(visible.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((5, 5), np.uint8)) > 0
                depth = np.where(visible, noisy, depth)
                nearest = np.where(visible, z, nearest)
                depth[edge & (rng.random(depth.shape) < 0.5)] = 0
            depth[~reached] = 0
            cv2.imwrite(os.path.join(a.output, "depth", f"{stamp}.png"),
                        np.clip(depth * a.depth_units + 0.5, 0, 65535).astype(np.uint16))
            f.write(f"{stamp} depth/{stamp}.png\n")
    json.dump(dict(source=os.path.basename(os.path.normpath(a.sequence)), camera=a.camera, seed=a.seed, mode=a.mode,
                   mean_covered=float(np.mean(covered)), max_covered=float(np.max(covered)),
                   people=[dict(cutout=w.name, **w.spec) for w in walkers]),
              open(os.path.join(a.output, "scene.json"), "w"), indent=1)
    print(f"{len(colour_rows)} colour, {len(depth_rows)} depth frames; people cover "
          f"{100*np.mean(covered):.1f} % of the image on average, {100*np.max(covered):.1f} % at most")


if __name__ == "__main__":
    main()
