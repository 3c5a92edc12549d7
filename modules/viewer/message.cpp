// SPDX-License-Identifier: BSD-3-Clause
#include "message.hpp"

#include <bit>

namespace holdfast::viewer {

static_assert(std::endian::native == std::endian::little, "the arrays are copied as they lie in memory");

std::string Message::bytes() const {
  nlohmann::json json = json_;
  if (!arrays_.empty()) json["arrays"] = arrays_;
  std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  text.resize((text.size() + 7) / 8 * 8, ' ');
  std::string bytes(8, '\0');
  const auto length = static_cast<std::uint32_t>(text.size());
  bytes.replace(0, sizeof(length), reinterpret_cast<const char*>(&length), sizeof(length));
  return bytes.append(text).append(data_);
}

}  // namespace holdfast::viewer
