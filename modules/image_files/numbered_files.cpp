// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/numbered_files.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <tuple>

#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string without_leading_zeros(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? "0" : std::string(digits.substr(first));
}

bool is_image_name(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw InputError({folder.string()},
                     std::string(std::filesystem::exists(folder, error) ? "is not a folder" : "is missing") +
                         "; expected a folder of numbered images; correct the path, or give a pattern such as "
                         "'colour/%06d.png'");
  std::vector<std::filesystem::path> files;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    files.push_back(entry->path());
  if (error) throw InputError({folder.string()}, "cannot be read: " + error.message() + "; check its permissions");
  std::sort(files.begin(), files.end());  // a folder's own order differs from machine to machine
  return files;
}

}  // namespace

FileNumbers numbers_of(const std::string& name) {
  FileNumbers numbers;
  for (std::size_t i = 0; i < name.size();) {
    std::size_t end = i;
    while (end < name.size() && is_digit(name[end])) ++end;
    if (end > i) numbers.push_back(without_leading_zeros(std::string_view(name).substr(i, end - i)));
    i = end + 1;
  }
  return numbers;
}

NumberPattern::NumberPattern(const std::filesystem::path& folder, const std::string& pattern)
    : whole_(folder / pattern), folder_(whole_.parent_path()) {
  const std::string name = whole_.filename().string();
  const std::size_t begin = name.find('%');
  std::size_t end = begin == std::string::npos ? begin : begin + 1;
  while (end < name.size() && is_digit(name[end])) ++end;
  const std::size_t count = end < name.size() ? end - begin - 1 : 0;
  const bool well_formed = begin != std::string::npos && end < name.size() && name[end] == 'd' && count != 1 &&
                           count <= 3 && (count == 0 || name[begin + 1] == '0') &&
                           std::count(pattern.begin(), pattern.end(), '%') == 1;
  if (!well_formed)
    throw InputError({whole_.string()},
                     "is not a pattern that can be used; expected exactly one number in the file name, written %d or, "
                     "with leading zeros, %06d");
  prefix_ = name.substr(0, begin);
  suffix_ = name.substr(end + 1);
  if (count > 0) std::from_chars(name.data() + begin + 1, name.data() + end, digits_);
}

std::filesystem::path NumberPattern::path_of(const std::string& number) const {
  const std::string zeros(number.size() < digits_ ? digits_ - number.size() : 0, '0');
  return folder_ / (prefix_ + zeros + number + suffix_);
}

std::vector<NumberedFile> NumberPattern::find() const {
  std::uint64_t lowest = 0, highest = 0;
  bool found_any = false;
  for (const std::filesystem::path& path : files_in(folder_)) {
    const std::string name = path.filename().string();
    if (name.size() <= prefix_.size() + suffix_.size() || !name.starts_with(prefix_) || !name.ends_with(suffix_))
      continue;
    const std::size_t length = name.size() - prefix_.size() - suffix_.size();
    const auto number = parsed_number<std::uint64_t>(std::string_view(name).substr(prefix_.size(), length));
    if (!number || path_of(std::to_string(*number)) != path) continue;
    lowest = found_any ? std::min(lowest, *number) : *number;
    highest = std::max(highest, *number);
    found_any = true;
  }
  if (!found_any)
    throw InputError({whole_.string()}, "fits no file; expected at least one image of that name; correct the pattern");
  // Ten million frames are four days of video: more is a stray file, and listing the gap would fill the memory.
  if (highest - lowest > 10'000'000)
    throw InputError({whole_.string()}, "fits files with the numbers " + std::to_string(lowest) + " and " +
                                            std::to_string(highest) + "; expected a sequence; take the stray file out");
  std::vector<NumberedFile> files;
  for (std::uint64_t number = lowest; number <= highest; ++number) {
    const std::string text = std::to_string(number);
    files.push_back({{text}, path_of(text)});
  }
  return files;
}

namespace {

/// Files of a folder by their numbers; `thing` and `expected` name them in messages.
template <class IsWanted>
std::vector<NumberedFile> find_files(const std::filesystem::path& folder, const std::string& thing,
                                     const std::string& expected, IsWanted&& is_wanted) {
  std::vector<NumberedFile> files;
  for (const std::filesystem::path& path : files_in(folder)) {
    if (!is_wanted(path)) continue;
    FileNumbers numbers = numbers_of(path.stem().string());
    if (numbers.empty())
      throw InputError({path.string()},
                       "has no number in its name; expected numbered " + thing + "s; move it elsewhere");
    files.push_back({std::move(numbers), path});
  }
  if (files.empty())
    throw InputError({folder.string()}, "holds no " + thing + "; expected numbered " + expected + "; correct the path");
  std::stable_sort(files.begin(), files.end(), [](const NumberedFile& left, const NumberedFile& right) {
    return comes_before(left.numbers, right.numbers);
  });
  for (std::size_t i = 1; i < files.size(); ++i)
    if (files[i - 1].numbers == files[i].numbers)
      throw InputError({files[i].path.string()}, "has the same number as '" + files[i - 1].path.string() +
                                                     "'; expected one " + thing +
                                                     " for each number; move one elsewhere");
  return files;
}

}  // namespace

std::vector<NumberedFile> find_numbered_files(const std::filesystem::path& folder) {
  return find_files(folder, "image", "PNG or JPEG files", is_image_name);
}

std::vector<NumberedFile> find_numbered_files(const std::filesystem::path& folder, const std::string& extension) {
  return find_files(folder, "file", extension + " files",
                    [&](const std::filesystem::path& path) { return path.extension() == extension; });
}

std::vector<std::filesystem::path> find_partners(const std::vector<NumberedFile>& files,
                                                 const std::filesystem::path& folder, const std::string& extension) {
  const std::vector<NumberedFile> others = find_numbered_files(folder);
  std::vector<std::filesystem::path> partners;
  partners.reserve(files.size());
  std::size_t next = 0;
  for (const NumberedFile& file : files) {
    while (next < others.size() && comes_before(others[next].numbers, file.numbers)) ++next;
    const bool found = next < others.size() && others[next].numbers == file.numbers;
    const std::filesystem::path own_ending = file.path.filename();
    const std::filesystem::path wanted =
        extension.empty() ? own_ending : std::filesystem::path(file.path.stem().string() + extension);
    partners.push_back(found ? others[next].path : folder / wanted);
  }
  return partners;
}

bool comes_before(const FileNumbers& left, const FileNumbers& right) {
  return std::lexicographical_compare(left.begin(), left.end(), right.begin(), right.end(),
                                      [](const std::string& a, const std::string& b) {
                                        return std::forward_as_tuple(a.size(), a) < std::forward_as_tuple(b.size(), b);
                                      });
}

}  // namespace holdfast
