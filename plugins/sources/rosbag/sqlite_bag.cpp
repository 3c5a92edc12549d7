// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <limits>

#include "chunk.hpp"
#include "holdfast/core/input_file.hpp"

namespace holdfast::rosbag_plugin {

namespace {

/// The name of a file as SQLite wants it, with characters that mean something escaped.
std::string database_address(const std::filesystem::path& file) {
  std::string address = "file:";
  for (const char character : std::filesystem::absolute(file).string()) {
    if (character == '%' || character == '?' || character == '#') {
      constexpr const char* digits = "0123456789ABCDEF";
      const auto code = static_cast<unsigned char>(character);
      address += {'%', digits[code >> 4U], digits[code & 15U]};
    } else {
      address += character;
    }
  }
  // A log that was not merged belongs to the content; without one nothing is written beside the file.
  std::error_code ignored;
  const std::filesystem::path log = file.string() + "-wal";
  const bool has_log = std::filesystem::exists(log, ignored) && std::filesystem::file_size(log, ignored) > 0;
  return address + (has_log ? "?mode=ro" : "?mode=ro&immutable=1");
}

/// Whether a database has fewer bytes than its header says (sqlite.org/fileformat2.html, 1.3). SQLite reads the missing
/// part of a last page as zeros.
bool is_truncated(const std::filesystem::path& file) {
  InputFile input(file, largest_file::unbounded, "a database of rosbag2");
  std::array<unsigned char, 100> header{};
  if (input.read(header.data(), header.size()) != header.size()) return true;
  const auto number = [&](std::size_t at) {
    return std::uint64_t{header[at]} << 24 | std::uint64_t{header[at + 1]} << 16 | std::uint64_t{header[at + 2]} << 8 |
           header[at + 3];
  };
  const std::uint64_t page = header[16] == 0 && header[17] == 1 ? 65536 : std::uint64_t{header[16]} << 8 | header[17];
  const bool has_count = number(24) == number(92);  // not in files of very old versions
  return has_count && input.size() < page * number(28);
}

class SqliteBag final : public Bag {
 public:
  SqliteBag(const std::filesystem::path& file, const std::filesystem::path& shown) : Bag(shown) {
    if (is_truncated(file)) fail(what_is_wrong("the file is shorter than it says"));
    sqlite3* database = nullptr;
    const int result = sqlite3_open_v2(database_address(file).c_str(), &database,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(database);
    if (result != SQLITE_OK) refuse();
    // The file is not trusted: no code of its schema runs, and a value takes no more than a message may.
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(largest_chunk));
    check_tables();
    read_topics();
    read_messages();
  }

  Bytes read(const BagMessage& message, std::uint64_t most) override {
    const auto row = static_cast<sqlite3_int64>(message.offset);
    if (!content_ || sqlite3_blob_reopen(content_.get(), row) != SQLITE_OK) {
      sqlite3_blob* content = nullptr;
      if (sqlite3_blob_open(database_.get(), "main", "messages", "data", row, 0, &content) != SQLITE_OK) refuse();
      content_.reset(content);
    }
    const auto size = static_cast<std::uint64_t>(sqlite3_blob_bytes(content_.get()));
    const auto count = static_cast<int>(std::min({size, most, std::uint64_t{largest_chunk}}));
    buffer_.resize(static_cast<std::size_t>(count));
    if (sqlite3_blob_read(content_.get(), buffer_.data(), count, 0) != SQLITE_OK) refuse();
    return buffer_;
  }

 private:
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

  std::string what_is_wrong(const std::string& reason) const {
    return "cannot be read as a database (" + reason +
           "): it is truncated or damaged, or still being recorded; copy it again, or save what is left of it by "
           "`sqlite3 " +
           path().string() + " .recover`";
  }
  [[noreturn]] void refuse() const { fail(what_is_wrong(sqlite3_errmsg(database_.get()))); }
  Statement query(const char* text) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), text, -1, &statement, nullptr) != SQLITE_OK) refuse();
    return {statement, &sqlite3_finalize};
  }
  bool has_row(const Statement& statement) const {
    const int result = sqlite3_step(statement.get());
    if (result != SQLITE_ROW && result != SQLITE_DONE) refuse();
    return result == SQLITE_ROW;
  }
  std::string text_in(const Statement& statement, int column) const {
    if (sqlite3_column_type(statement.get(), column) != SQLITE_TEXT)
      fail("has a topic without a name or type; it is damaged, copy it again");
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
    return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement.get(), column))};
  }
  std::int64_t number_in(const Statement& statement, int column) const {
    if (sqlite3_column_type(statement.get(), column) != SQLITE_INTEGER)
      fail("has a message or topic without its number or time; it is damaged, copy it again");
    return sqlite3_column_int64(statement.get(), column);
  }

  /// Views and virtual tables could compute anything.
  void check_tables() const {
    const Statement tables = query(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages') AND "
        "sql NOT LIKE 'CREATE VIRTUAL%'");
    if (!has_row(tables) || sqlite3_column_int(tables.get(), 0) != 2)
      fail("is a database without the tables `topics` and `messages`; expected one of rosbag2");
  }
  void read_topics() {
    const Statement topics = query("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (has_row(topics)) {
      const std::int64_t id = number_in(topics, 0);
      const bool is_number = id >= 0 && id <= std::numeric_limits<std::uint32_t>::max();
      if (!is_number || !add_connection(static_cast<std::uint32_t>(id),
                                        {text_in(topics, 1), text_in(topics, 2), text_in(topics, 3), {}}))
        fail("has the topic " + std::to_string(id) + " twice; it is damaged, copy it again");
    }
  }
  void read_messages() {
    const Statement messages = query("SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
    while (has_row(messages)) {
      const std::int64_t row = number_in(messages, 0), topic = number_in(messages, 1), time = number_in(messages, 2);
      const bool is_known = topic >= 0 && topic <= std::numeric_limits<std::uint32_t>::max() &&
                            has_connection(static_cast<std::uint32_t>(topic));
      if (!is_known || time < 0)
        fail("has message " + std::to_string(row) + " of topic " + std::to_string(topic) + " at " +
             std::to_string(time) + " ns; expected a topic of its list and a time; it is damaged, copy it again");
      add_message(
          {static_cast<std::uint64_t>(time), static_cast<std::uint32_t>(topic), 0, static_cast<std::uint64_t>(row)});
    }
  }

  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, &sqlite3_close_v2};
  std::unique_ptr<sqlite3_blob, int (*)(sqlite3_blob*)> content_{nullptr, &sqlite3_blob_close};
  std::vector<std::uint8_t> buffer_;
};

}  // namespace

std::unique_ptr<Bag> open_sqlite_bag(const std::filesystem::path& file, const std::filesystem::path& shown) {
  return std::make_unique<SqliteBag>(file, shown);
}

}  // namespace holdfast::rosbag_plugin
