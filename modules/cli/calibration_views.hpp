// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/calibration/board_detector.hpp"
#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast {

/// Collects views of a board from images that come one by one, from files, a video or a source.
class CalibrationViews {
 public:
  struct Options {
    std::uint64_t every = 0;      ///< of a video or a source, look at every n-th image; 0 = every fifth
    std::size_t most_views = 60;  ///< of a video or a source
    bool quiet = false;
  };

  CalibrationViews(const CalibrationBoard& board, const Options& options) : detector_(board), options_(options) {}

  /// Images of a folder (PNG, JPEG) by name, single images, and videos. Every image with the board is taken; of a video
  /// as of a source. Throws InputError that names the file.
  void add_files(const std::vector<std::filesystem::path>& files);
  /// Of images that follow each other, those are taken in which the board stands elsewhere than in all before.
  void add_source(FrameSource& source);

  const std::vector<BoardView>& views() const { return views_; }
  /// Images that were looked at, with and without the board.
  std::size_t looked_at() const { return looked_at_; }
  const cv::Size& size() const { return size_; }

 private:
  void add_video(const std::filesystem::path& file);
  /// Takes an image that stands alone.
  void add_image(const cv::Mat& grey, const std::string& name);
  /// Takes one of a sequence, if it shows something new. Returns false when there are enough.
  bool add_following(const cv::Mat& image, const std::string& name);
  void require_size(const cv::Mat& image, const std::string& name);
  bool is_new(const BoardView& view) const;

  BoardDetector detector_;
  Options options_;
  std::vector<BoardView> views_;
  std::size_t looked_at_ = 0;
  std::uint64_t sequence_ = 0;
  cv::Size size_;
  std::string first_;  ///< name of the first image, which determines the size
};

}  // namespace holdfast
