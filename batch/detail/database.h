#pragma once
/// SQLite for what is written once and in order.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace sunder::batch::detail {

/// A prepared statement; rows are bound from the left.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql);
  ~Statement();
  Statement(Statement&&) noexcept;
  Statement& operator=(Statement&&) = delete;

  Statement& bind(const std::string& text);
  Statement& bind(double number);
  Statement& bind(std::int64_t number);
  Statement& bind_nothing();
  /// Runs a statement that gives no rows, and makes it ready for the next.
  void run();
  /// False when there is no further row.
  bool next();

  std::string text(int column) const;
  double number(int column) const;
  std::int64_t integer(int column) const;
  bool is_null(int column) const;
  int columns() const;

 private:
  void require(int status) const;

  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

/// A file. Errors of all: ErrorKind::io with SQLite's reason.
class Database {
 public:
  enum class Use { write, read };
  Database(const std::filesystem::path& file, Use use);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql);
  Statement prepare(const std::string& sql);
  /// Says why when it cannot be closed in good order.
  void close();

 private:
  std::filesystem::path file_;
  sqlite3* database_ = nullptr;
};

/// "name" with its quotes.
std::string quoted(const std::string& name);

}  // namespace sunder::batch::detail
