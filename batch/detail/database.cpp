#include "batch/detail/database.h"

#include <utility>

#include <sqlite3.h>

#include "core/error.h"

namespace sunder::batch::detail {
namespace {

[[noreturn]] void fail(sqlite3* database) {
  const char* file = sqlite3_db_filename(database, "main");
  throw Error(ErrorKind::io, std::string(file ? file : "database") + ": " + sqlite3_errmsg(database));
}

}  // namespace

Statement::Statement(sqlite3* database, const std::string& sql) : database_(database) {
  require(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_), statement_(std::exchange(other.statement_, nullptr)), bound_(other.bound_) {}

void Statement::require(int status) const {
  if (status != SQLITE_OK) fail(database_);
}

Statement& Statement::bind(const std::string& text) {
  require(sqlite3_bind_text(statement_, ++bound_, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind(double number) {
  require(sqlite3_bind_double(statement_, ++bound_, number));
  return *this;
}

Statement& Statement::bind(std::int64_t number) {
  require(sqlite3_bind_int64(statement_, ++bound_, number));
  return *this;
}

Statement& Statement::bind_nothing() {
  require(sqlite3_bind_null(statement_, ++bound_));
  return *this;
}

void Statement::run() {
  if (sqlite3_step(statement_) != SQLITE_DONE) fail(database_);
  require(sqlite3_reset(statement_));
  bound_ = 0;
}

bool Statement::next() {
  const int status = sqlite3_step(statement_);
  if (status == SQLITE_ROW) return true;
  if (status != SQLITE_DONE) fail(database_);
  return false;
}

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(statement_, column);
  return text ? std::string(reinterpret_cast<const char*>(text),
                            static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
              : "";
}

double Statement::number(int column) const { return sqlite3_column_double(statement_, column); }

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }

bool Statement::is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

int Statement::columns() const { return sqlite3_column_count(statement_); }

Database::Database(const std::filesystem::path& file, Use use) : file_(file) {
  const int flags = use == Use::write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  if (sqlite3_open_v2(file.c_str(), &database_, flags, nullptr) == SQLITE_OK) return;
  const std::string why = database_ ? sqlite3_errmsg(database_) : "out of memory";
  sqlite3_close_v2(database_);
  throw Error(ErrorKind::io, file.string() + ": " + why);
}

Database::~Database() { sqlite3_close_v2(database_); }

void Database::run(const std::string& sql) {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail(database_);
}

Statement Database::prepare(const std::string& sql) { return {database_, sql}; }

void Database::close() {
  if (sqlite3_close(database_) != SQLITE_OK) fail(database_);
  database_ = nullptr;
}

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text.append(c == '"' ? 2 : 1, c);
  return text + "\"";
}

}  // namespace sunder::batch::detail
