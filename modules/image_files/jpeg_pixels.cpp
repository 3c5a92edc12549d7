// SPDX-License-Identifier: BSD-3-Clause
#include "jpeg_pixels.hpp"

#if defined(HOLDFAST_LIBJPEG)
#include <csetjmp>
#include <cstdio>  // jpeglib.h uses its types
#include <opencv2/imgproc.hpp>

extern "C" {
#include <jerror.h>
#include <jpeglib.h>
}
#else
#include <opencv2/imgcodecs.hpp>
#endif

namespace holdfast {

#if defined(HOLDFAST_LIBJPEG)

namespace {

/// What libjpeg asks when it meets something. Its functions are those of C: no exception may pass through them.
struct Listener {
  jpeg_error_mgr manager;  // first, so that a pointer to it is one to the listener
  jpeg_progress_mgr progress;
  std::jmp_buf gave_up;
};

[[noreturn]] void give_up(j_common_ptr decoder) { std::longjmp(reinterpret_cast<Listener*>(decoder->err)->gave_up, 1); }

/// Level -1 is a warning: all of them say that pixels are made up, except for these.
void hear(j_common_ptr decoder, int level) {
  if (level >= 0) return;
  switch (decoder->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:  // bytes between the segments, which some cameras write
    case JWRN_TOO_MUCH_DATA:
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
      return;
    default:
      give_up(decoder);
  }
}

void print_nothing(j_common_ptr) {}

/// A progressive image may have any number of scans, each of which takes as long as the image is large.
void limit_scans(j_common_ptr decoder) {
  constexpr int most_scans = 500;
  if (decoder->is_decompressor && reinterpret_cast<j_decompress_ptr>(decoder)->input_scan_number > most_scans)
    give_up(decoder);
}

/// Rows of red, green and blue. Holds nothing that would have to be destroyed when libjpeg gives up, and what
/// longjmp() would leave undefined is changed by the caller alone.
bool decode_rows(Listener& listener, jpeg_decompress_struct& decoder, std::span<const std::uint8_t> file,
                 cv::Mat& rows) {
  if (setjmp(listener.gave_up) != 0) return false;
  jpeg_create_decompress(&decoder);
  decoder.progress = &listener.progress;
  jpeg_mem_src(&decoder, file.data(), static_cast<unsigned long>(file.size()));
  jpeg_read_header(&decoder, TRUE);
  decoder.out_color_space = JCS_RGB;
  jpeg_start_decompress(&decoder);
  if (decoder.output_components != 3 || static_cast<int>(decoder.output_width) != rows.cols ||
      static_cast<int>(decoder.output_height) != rows.rows)
    return false;
  while (decoder.output_scanline < decoder.output_height) {
    JSAMPROW row = rows.ptr<std::uint8_t>(static_cast<int>(decoder.output_scanline));
    jpeg_read_scanlines(&decoder, &row, 1);
  }
  jpeg_finish_decompress(&decoder);
  return true;
}

}  // namespace

bool decode_jpeg(std::span<const std::uint8_t> file, const cv::Size& size, cv::Mat& colour) {
  Listener listener{};
  jpeg_decompress_struct decoder{};
  decoder.err = jpeg_std_error(&listener.manager);
  listener.manager.error_exit = &give_up;
  listener.manager.emit_message = &hear;
  listener.manager.output_message = &print_nothing;
  listener.progress.progress_monitor = &limit_scans;
  colour.create(size, CV_8UC3);
  const bool is_whole = decode_rows(listener, decoder, file, colour);
  jpeg_destroy_decompress(&decoder);
  if (is_whole) cv::cvtColor(colour, colour, cv::COLOR_RGB2BGR);
  return is_whole;
}

#else

bool decode_jpeg(std::span<const std::uint8_t> file, const cv::Size& size, cv::Mat& colour) {
  const cv::Mat input(1, static_cast<int>(file.size()), CV_8UC1, const_cast<std::uint8_t*>(file.data()));
  try {
    colour = cv::imdecode(input, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return false;
  }
  return colour.size() == size && colour.type() == CV_8UC3;
}

#endif

}  // namespace holdfast
