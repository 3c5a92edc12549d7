// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/builtin.hpp"

namespace holdfast::test {

/// A folder with Python files, gone when the test ends.
class PythonFiles : public testing::Test {
 protected:
  PythonFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_python_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    register_builtin_plugins(registry_);
  }
  ~PythonFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string write(const std::string& text, const std::string& name = "segmenter.py") const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::unique_ptr<Segmenter> make(const std::string& file, ParameterValues values = {}) const {
    values["file"] = file;
    return registry_.create<Segmenter>("python", values, {});
  }
  /// A segmenter whose segment() has this body, after `import numpy`.
  std::unique_ptr<Segmenter> with_body(const std::string& body) const {
    return make(
        write("import numpy\n\nclass Segmenter:\n    classes = ['background', 'person']\n\n"
              "    def segment(self, image):\n        " +
              body + "\n"));
  }
  static SensorFrame frame(int width = 6, int height = 4) {
    SensorFrame frame;
    frame.index = 3;
    frame.colour = cv::Mat(height, width, CV_8UC3, cv::Scalar(10, 20, 200));
    return frame;
  }
  /// What the InputError says; a failed expectation when there is none.
  template <class Call>
  static std::string error_of(Call&& call) {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return "";
  }

  std::filesystem::path folder_;
  Registry registry_;
};

}  // namespace holdfast::test
