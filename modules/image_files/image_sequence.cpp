// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "holdfast/core/size_text.hpp"
#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/image_structure.hpp"

namespace holdfast {

namespace {

/// Runs read; what is wrong with an image is told at the line of the list that names it.
template <class Read>
cv::Mat read_at(const SourceLocation& listed_at, Read&& read) {
  if (listed_at.file.empty()) return read();
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(listed_at, error.what());
  }
}

/// Nothing for a file that is no complete image.
std::optional<ImageStructure> structure_of(const std::filesystem::path& file) {
  try {
    const ImageStructure image = examine_image_ends(file);
    return image.problem.empty() ? std::optional(image) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Throws InputError if the colour image has the form of a depth image, and the depth image that of a colour image.
void require_order(const ImageFiles& files) {
  if (files.depth.empty()) return;
  const std::optional<ImageStructure> colour = structure_of(files.colour), depth = structure_of(files.depth);
  if (!colour || !depth || colour->bits != 16 || colour->channels != 1 || depth->bits != 8) return;
  throw InputError(
      {files.colour.string()},
      "is a depth image, 1 channel of 16 bits, and '" + files.depth.string() +
          "', which should be the depth image of this frame, has 8 bits: colour and depth are exchanged; " +
          (files.colour_listed_at.file.empty() ? "exchange the names of their folders in the configuration"
           : files.colour_listed_at.file == files.depth_listed_at.file
               ? "exchange the columns of the associations: colour before depth"
               : "exchange the names of the two lists"));
}

/// Whether images of these sizes can show the same view: their sides have the same ratio to 1 %.
bool have_same_ratio(const cv::Size& a, const cv::Size& b) {
  constexpr double tolerance = 0.01;
  return std::abs(static_cast<double>(a.width) * b.height - static_cast<double>(a.height) * b.width) <=
         tolerance * a.width * b.height;
}

const char* advice_on_size(const cv::Size& depth, const cv::Size& colour) {
  return have_same_ratio(depth, colour) ? ", or the source `folder` with `scale_depth: true` if both show the same view"
                                        : "";
}

void require_same_view(const ImageFiles& files, const cv::Size& depth, const cv::Size& colour) {
  if (have_same_ratio(depth, colour)) return;
  throw InputError({files.depth.string()},
                   "is " + size_text(depth.width, depth.height) + " pixels, and its colour image '" +
                       files.colour.string() + "' is " + size_text(colour.width, colour.height) +
                       ": they do not show the same view, so that depth cannot be scaled; expected depth registered to "
                       "the colour image");
}

cv::Mat scaled_depth(const cv::Mat& depth, const cv::Size& size) {
  cv::Mat result(size, CV_32FC1);
  std::vector<int> column(static_cast<std::size_t>(size.width));
  for (int x = 0; x < size.width; ++x)
    column[static_cast<std::size_t>(x)] = static_cast<int>((2LL * x + 1) * depth.cols / (2LL * size.width));
  for (int y = 0; y < size.height; ++y) {
    const auto* from = depth.ptr<float>(static_cast<int>((2LL * y + 1) * depth.rows / (2LL * size.height)));
    auto* to = result.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) to[x] = from[column[static_cast<std::size_t>(x)]];
  }
  return result;
}

}  // namespace

ImageSequence::ImageSequence(std::vector<ImageFiles> files, const ImageSequenceOptions& options)
    : files_(std::move(files)), options_(options) {
  decoder_.accept_16_bits(options.grey_may_have_16_bits);
  for (std::size_t i = 1; i < files_.size(); ++i)
    HOLDFAST_CHECK(files_[i - 1].timestamp < files_[i].timestamp,
                   files_[i - 1].timestamp << " before " << files_[i].timestamp);
}

std::vector<double> ImageSequence::timestamps() const {
  std::vector<double> stamps;
  stamps.reserve(files_.size());
  for (const ImageFiles& files : files_) stamps.push_back(files.timestamp);
  return stamps;
}

ImageDecoder::SizeCheck ImageSequence::size_check(const std::filesystem::path& file, const cv::Size& camera) {
  return [this, file, camera](const cv::Size& size) {
    is_of_other_size_ = size != camera;
    if (is_of_other_size_)
      throw InputError({file.string()}, "is " + size_text(size.width, size.height) + " pixels, but the camera is " +
                                            size_text(camera.width, camera.height) +
                                            "; give the camera of this recording under `camera:`, or scale the images");
  };
}

SensorFrame ImageSequence::decode(const ImageFiles& files) {
  SensorFrame frame;
  frame.timestamp = files.timestamp;
  frame.depth_delay = files.depth_delay;
  const StereoRectification* rectification = options_.rectification.get();
  cv::Size left_size(options_.width, options_.height), right_size = left_size;
  if (rectification != nullptr) {
    const StereoCameras& pair = rectification->calibration();
    left_size = {pair.left.width, pair.left.height};
    right_size = {pair.right.width, pair.right.height};
  }
  frame.colour = read_at(files.colour_listed_at, [&] { return decode_colour(files, left_size); });
  if (!files.right.empty())
    frame.right = read_at(files.right_listed_at,
                          [&] { return decoder_.read_grey(files.right, size_check(files.right, right_size)); });
  if (rectification != nullptr) {
    frame.colour = rectification->rectify_left(frame.colour);
    frame.right = rectification->rectify_right(frame.right);
  }
  if (!files.depth.empty())
    frame.depth = read_at(files.depth_listed_at, [&] { return decode_depth(files, frame.colour.size()); });
  return frame;
}

cv::Mat ImageSequence::decode_colour(const ImageFiles& files, const cv::Size& expected) {
  const ImageDecoder::SizeCheck check_size = size_check(files.colour, expected);
  cv::Mat colour;
  try {
    colour = options_.readers.colour ? options_.readers.colour(files) : decoder_.read_widened(files.colour, check_size);
  } catch (const InputError&) {
    require_order(files);
    throw;
  }
  if (options_.readers.colour) check_size(colour.size());
  if (options_.frame_size.empty() || colour.size() == options_.frame_size) return colour;
  cv::Mat scaled;
  cv::resize(colour, scaled, options_.frame_size, 0.0, 0.0, cv::INTER_AREA);
  return scaled;
}

cv::Mat ImageSequence::decode_depth(const ImageFiles& files, const cv::Size& colour_size) {
  const auto check_size = [&](const cv::Size& size) {
    is_of_other_size_ = size != colour_size;
    if (is_of_other_size_ && options_.scales_depth) {
      require_same_view(files, size, colour_size);
      is_of_other_size_ = false;
    }
    if (is_of_other_size_)
      throw InputError({files.depth.string()}, "is " + size_text(size.width, size.height) +
                                                   " pixels, but its colour image '" + files.colour.string() + "' is " +
                                                   size_text(colour_size.width, colour_size.height) +
                                                   "; expected depth registered to the colour image, pixel by pixel" +
                                                   advice_on_size(size, colour_size));
  };
  cv::Mat depth;
  if (options_.readers.depth) {
    depth = options_.readers.depth(files);
    check_size(depth.size());
  } else {
    depth = decoder_.read_depth(files.depth, options_.depth, check_size);
  }
  if (!files.confidence.empty() && options_.minimum_confidence > 0) remove_unsure_depth(files, depth);
  return depth.size() == colour_size ? depth : scaled_depth(depth, colour_size);
}

void ImageSequence::remove_unsure_depth(const ImageFiles& files, cv::Mat& depth) {
  const cv::Mat confidence = decoder_.read_grey(files.confidence, [&](const cv::Size& size) {
    if (size != depth.size())
      throw InputError({files.confidence.string()}, "is " + size_text(size.width, size.height) +
                                                        " pixels, but its depth image '" + files.depth.string() +
                                                        "' is " + size_text(depth.cols, depth.rows) +
                                                        "; expected one value for each depth");
  });
  depth.setTo(0.0F, confidence < options_.minimum_confidence);
}

std::optional<Diagnostic> ImageSequence::suspected_no_value() const {
  if (options_.invalid_depth_key.empty() || files_.empty() || files_.front().depth.empty()) return std::nullopt;
  constexpr std::size_t most = 4;
  const std::size_t step = (files_.size() + most - 1) / most;
  ImageDecoder decoder;
  std::vector<cv::Mat> depths;
  for (std::size_t i = 0; i < files_.size(); i += step) {
    try {
      depths.push_back(decoder.read_depth(files_[i].depth, options_.depth));
    } catch (const InputError&) {  // told when its turn comes
    }
  }
  const std::optional<float> depth = find_no_value(depths);
  if (!depth) return std::nullopt;
  const std::string stored = std::to_string(std::lround(*depth * options_.depth.factor));
  const std::string metres = std::to_string(*depth);
  return Diagnostic{{files_.front().depth.string()},
                    "the largest depth " + metres.substr(0, metres.find('.') + 3) + " m (stored as " + stored +
                        ") fills a part of the image far behind everything else, in images all over the recording: it "
                        "looks like 'no value'; set `" +
                        options_.invalid_depth_key + ": " + stored + "` then"};
}

std::optional<Diagnostic> ImageSequence::suspected_stamp_unit() const {
  if (!options_.stamps_are_read) return std::nullopt;
  std::vector<double> stamps;
  for (const ImageFiles& files : files_) stamps.push_back(files.timestamp);
  const std::string unit = stamp_unit_suspicion(stamps);
  if (unit.empty()) return std::nullopt;
  Diagnostic warning;
  warning.location.file = files_.front().colour_listed_at.file;  // images in numbered folders have no list
  warning.message = "the time stamps of the frames " + unit +
                    "; expected seconds: the motion between frames, and how long a camera may be lost, depend on them";
  return warning;
}

Warnings ImageSequence::warnings() const {
  if (warnings_) return *warnings_;
  warnings_.emplace();
  for (std::optional<Diagnostic> suspicion : {suspected_stamp_unit(), suspected_no_value()})
    if (suspicion) add_warning(*warnings_, std::move(*suspicion));
  return *warnings_;
}

std::optional<SensorFrame> ImageSequence::next() {
  while (position_ < files_.size()) {
    const std::uint64_t index = position_++;
    try {
      SensorFrame frame = decode(files_[index]);
      frame.index = index;
      return frame;
    } catch (const InputError& error) {
      // Where the first image has another size, all have it: to leave out such frames would leave out all.
      if (!options_.skip_bad_frames && is_of_other_size_ && index == 0) throw;
      if (!options_.skip_bad_frames)
        throw InputError(error.location(), std::string(error.what()).substr(error.location().to_string().size() + 2) +
                                               "; or leave out such frames with `on_bad_frame: skip`");
      skipped_.push_back({index, files_[index].timestamp, error.what()});
    }
  }
  if (!files_.empty() && skipped_.size() == files_.size())
    throw InputError({}, "none of the " + std::to_string(files_.size()) +
                             " frames can be used; the first: " + skipped_.front().reason);
  return std::nullopt;
}

std::vector<double> ImageSequence::pass_over(double timestamp) {
  std::vector<double> stamps;
  for (; position_ + 1 < files_.size() && files_[position_ + 1].timestamp <= timestamp; ++position_)
    stamps.push_back(files_[position_].timestamp);
  return stamps;
}

namespace {

/// The largest depth of an image, if it stands out; 0 otherwise, and nothing without a measurement.
std::optional<float> outstanding_depth(const cv::Mat& depth) {
  float largest = 0.0F, second = 0.0F;
  std::size_t count = 0;
  std::set<float> others;  // a picture of few depths is drawn, and its background may be far
  constexpr std::size_t enough_others = 32;
  for (int y = 0; y < depth.rows; ++y) {
    const auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      if (row[x] > largest) {
        second = largest;
        largest = row[x];
        count = 0;
      } else if (row[x] > second && row[x] < largest) {
        second = row[x];
      }
      count += row[x] == largest && largest > 0.0F ? 1 : 0;
      if (others.size() < enough_others) others.insert(row[x]);
    }
  }
  if (largest == 0.0F) return std::nullopt;
  constexpr float gap = 1.25F;
  constexpr std::size_t least_share = 100;  // 1 / share
  const bool stands_out =
      largest > gap * second && count * least_share >= depth.total() && others.size() >= enough_others;
  return stands_out ? largest : 0.0F;
}

}  // namespace

std::optional<float> find_no_value(const std::vector<cv::Mat>& depths) {
  std::vector<float> values;
  for (const cv::Mat& depth : depths)
    if (const std::optional<float> value = outstanding_depth(depth)) values.push_back(*value);
  constexpr std::size_t fewest = 3;
  const bool is_common = values.size() >= fewest && values.front() > 0.0F &&
                         std::all_of(values.begin(), values.end(), [&](float v) { return v == values.front(); });
  return is_common ? std::optional(values.front()) : std::nullopt;
}

void require_recording_folder(const std::filesystem::path& folder, const std::string& expected,
                              const std::string& setting) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  throw InputError({folder.string()},
                   std::string(std::filesystem::exists(folder, error) ? "is not a folder" : "is missing") +
                       "; expected " + expected + "; set `" + setting + "`");
}

void set_stamps(std::vector<ImageFiles>& files, const std::filesystem::path& stamps, double frame_rate) {
  if (stamps.empty()) {
    for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = static_cast<double>(i) / frame_rate;
    return;
  }
  const std::vector<ListedImage> listed = read_stamp_list(stamps);
  if (listed.size() != files.size())
    throw InputError({stamps.string(), listed.back().line},
                     "the file ends with " + std::to_string(listed.size()) + " stamps, but there are " +
                         std::to_string(files.size()) + " images from '" + files.front().colour.string() + "' to '" +
                         files.back().colour.string() + "'; expected one stamp for each");
  for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = listed[i].timestamp;
}

}  // namespace holdfast
