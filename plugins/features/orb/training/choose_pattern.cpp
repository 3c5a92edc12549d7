// SPDX-License-Identifier: BSD-3-Clause
// Chooses the 256 tests of the descriptor from photographs: see README.md. Writes pattern.inl to standard output.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brief.hpp"
#include "detector.hpp"
#include "holdfast/core/random.hpp"
#include "kernels.hpp"
#include "orb.hpp"
#include "pyramid.hpp"

namespace {

using namespace holdfast;

struct Position {
  int x, y;
};

std::vector<Position> disc() {
  std::vector<Position> positions;
  constexpr int limit =
      4 * orb_plugin::brief_radius * orb_plugin::brief_radius;  // (r - 0.5)^2: a rotated sample stays within r
  for (int y = -orb_plugin::brief_radius; y <= orb_plugin::brief_radius; ++y)
    for (int x = -orb_plugin::brief_radius; x <= orb_plugin::brief_radius; ++x)
      if (4 * (x * x + y * y) <= limit - 4 * orb_plugin::brief_radius + 1) positions.push_back({x, y});
  return positions;
}

/// Grey values of the disc around features, turned by their orientation; by position of the disc, then by feature.
struct Patches {
  std::vector<std::vector<std::uint8_t>> grey;
};

/// The blurred pyramid that descriptors are taken from.
class Sampler {
 public:
  Sampler(const cv::Mat& image, const ScalePyramid& scales)
      : kernels_(orb_plugin::kernels(simd_level())), pyramid_(scales, kernels_) {
    pyramid_.build(image, orb_plugin::CornerDetector::minimum_image_size);
    for (int level = 0; level < pyramid_.levels(); ++level) {
      const orb_plugin::ImageView& view = pyramid_.view(level);
      std::vector<std::uint8_t> row(view.width);
      blurred_.emplace_back(cv::Mat::zeros(view.height, view.width, CV_8UC1));
      kernels_.blur(view.data, view.stride, view.width, view.height, row.data(), blurred_.back().data,
                    static_cast<std::ptrdiff_t>(blurred_.back().step));
    }
  }

  void append(const Features& features, std::size_t i, const std::vector<Position>& positions, Patches& patches) const {
    const int level = features.octave[i];
    const float ratio_x = pyramid_.full_x(level, 1) - pyramid_.full_x(level, 0);
    const float ratio_y = pyramid_.full_y(level, 1) - pyramid_.full_y(level, 0);
    const auto x = static_cast<int>(std::lround((features.x[i] + 0.5F) / ratio_x - 0.5F));
    const auto y = static_cast<int>(std::lround((features.y[i] + 0.5F) / ratio_y - 0.5F));
    const double cosine = std::cos(features.angle[i]), sine = std::sin(features.angle[i]);
    for (std::size_t p = 0; p < positions.size(); ++p) {
      const auto [u, v] = positions[p];
      patches.grey[p].push_back(
          blurred_[level].at<std::uint8_t>(y + static_cast<int>(std::lround(sine * u + cosine * v)),
                                           x + static_cast<int>(std::lround(cosine * u - sine * v))));
    }
  }

 private:
  const orb_plugin::Kernels& kernels_;
  orb_plugin::ImagePyramid pyramid_;
  std::vector<cv::Mat> blurred_;
};

/// The same scene seen again: turned, scaled, with another exposure and noise.
cv::Mat seen_again(const cv::Mat& image, Random& random, cv::Matx23d& transform) {
  const cv::Point2f centre(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
  const double scale = random.uniform(0.85, 1.15), degrees = random.uniform(-30, 30);
  transform = cv::getRotationMatrix2D(centre, degrees, scale);
  cv::Mat again;
  cv::warpAffine(image, again, transform, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  const double gain = random.uniform(0.8, 1.2), offset = random.uniform(-15, 15);
  for (int y = 0; y < again.rows; ++y)
    for (int x = 0; x < again.cols; ++x) {
      std::uint8_t& grey = again.at<std::uint8_t>(y, x);
      grey = cv::saturate_cast<std::uint8_t>(gain * grey + offset + 4.0 * random.normal());
    }
  return again;
}

void collect(const cv::Mat& image, OrbExtractor& extractor, Random& random, const std::vector<Position>& positions,
             Patches& first, Patches& second) {
  cv::Matx23d transform;
  const cv::Mat again = seen_again(image, random, transform);
  Features a, b;
  extractor.extract(image, cv::Mat(), a);
  extractor.extract(again, cv::Mat(), b);
  const Sampler sampler_a(image, extractor.pyramid()), sampler_b(again, extractor.pyramid());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = transform(0, 0) * a.x[i] + transform(0, 1) * a.y[i] + transform(0, 2);
    const double y = transform(1, 0) * a.x[i] + transform(1, 1) * a.y[i] + transform(1, 2);
    double nearest = 1.5 * extractor.pyramid().scale[a.octave[i]];
    std::size_t partner = b.size();
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double distance = std::hypot(b.x[j] - x, b.y[j] - y);
      if (std::abs(a.octave[i] - b.octave[j]) <= 1 && distance < nearest) nearest = distance, partner = j;
    }
    if (partner == b.size()) continue;
    sampler_a.append(a, i, positions, first);
    sampler_b.append(b, partner, positions, second);
  }
}

struct Candidate {
  int p, q;
  double cost;  ///< how often the bit differs between two views of one feature, relative to two features
};

int count_less(const std::uint8_t* a, const std::uint8_t* b, int count) {
  int total = 0;
  for (int i = 0; i < count; ++i) total += a[i] < b[i];
  return total;
}

int count_flips(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, const std::uint8_t* d, int count) {
  int total = 0;
  for (int i = 0; i < count; ++i) total += (a[i] < b[i]) != (c[i] < d[i]);
  return total;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: orb_choose_pattern FOLDER_OF_IMAGES [MAXIMUM_CORRELATION] > pattern.inl\n";
    return 2;
  }
  const double first_limit = argc > 2 ? std::atof(argv[2]) : 0.56;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());

  const std::vector<Position> positions = disc();
  Patches first, second;
  first.grey.resize(positions.size());
  second.grey.resize(positions.size());
  OrbSettings settings;
  settings.count = 400;
  settings.subpixel = false;  // so that a position names a pixel of its level
  OrbExtractor extractor(settings);
  Random random(1);
  for (const auto& file : files) {
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    if (!image.empty()) collect(image, extractor, random, positions, first, second);
  }
  const int count = static_cast<int>(first.grey[0].size());
  std::cerr << files.size() << " images, " << count << " features seen twice\n";
  if (count < 1000) return 1;

  std::vector<Candidate> candidates;
  for (int p = 0; p < static_cast<int>(positions.size()); ++p)
    for (int q = p + 1; q < static_cast<int>(positions.size()); ++q) {
      const std::uint8_t *a = first.grey[p].data(), *b = first.grey[q].data();
      const double mean = static_cast<double>(count_less(a, b, count)) / count;
      if (std::abs(mean - 0.5) > 0.15) continue;
      const double flips =
          static_cast<double>(count_flips(a, b, second.grey[p].data(), second.grey[q].data(), count)) / count;
      candidates.push_back({p, q, flips / (2 * mean * (1 - mean))});
    }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.p != b.p ? a.p < b.p : a.q < b.q;
  });
  std::cerr << candidates.size() << " candidates, costs " << candidates.front().cost << " to " << candidates.back().cost
            << "\n";

  // Best first, unless too much like one that was taken; the limit is raised until there are 256.
  using Bits = std::vector<std::uint64_t>;
  const auto bits_of = [&](const Candidate& c) {
    Bits bits((count + 63) / 64);
    for (int i = 0; i < count; ++i)
      bits[i / 64] |= static_cast<std::uint64_t>(first.grey[c.p][i] < first.grey[c.q][i]) << (i % 64);
    return bits;
  };
  std::vector<Candidate> chosen;
  double limit = first_limit;
  for (;; limit += 0.02) {
    chosen.clear();
    std::vector<Bits> taken;
    for (const Candidate& candidate : candidates) {
      const Bits bits = bits_of(candidate);
      const bool is_new = std::none_of(taken.begin(), taken.end(), [&](const Bits& other) {
        int differing = 0;
        for (std::size_t w = 0; w < bits.size(); ++w) differing += std::popcount(bits[w] ^ other[w]);
        return std::abs(1.0 - 2.0 * differing / count) > limit;
      });
      if (!is_new) continue;
      taken.push_back(bits);
      chosen.push_back(candidate);
      if (chosen.size() == 256) break;
    }
    std::cerr << "correlation up to " << limit << ": " << chosen.size() << " tests\n";
    if (chosen.size() == 256) break;
  }

  std::cout
      << "// SPDX-License-Identifier: BSD-3-Clause\n// Made by training/choose_pattern.cpp; see training/README.md.\n";
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Position a = positions[chosen[i].p], b = positions[chosen[i].q];
    std::cout << "{" << a.x << ", " << a.y << ", " << b.x << ", " << b.y << "}," << (i % 6 == 5 ? "\n" : " ");
  }
  std::cout << "\n";
}
