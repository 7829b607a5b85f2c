#pragma once
/// Strict reading of TOML: tables of keys say what a section holds; everything else is an error with file and line.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "core/error.h"
#include "core/types.h"

namespace sunder::pipeline::detail {

/// The candidate that `word` was probably meant to be: at most a third of its letters (and at least two) away; empty:
/// none is near.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'velocity'?", or "; expected one of: a, b, c" when nothing is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

/// Throws Error(usage) "file:line: message".
[[noreturn]] void fail(const std::filesystem::path& file, int line, const std::string& message);

/// Parses a file. Errors: ErrorKind::usage for a missing file and for a syntax error.
toml::table parse_file(const std::filesystem::path& file);

struct Section;

/// One value with its place, for reading and for complaining about it.
class Value {
 public:
  Value(const std::filesystem::path& file, const toml::node& node, std::string subject)
      : file_(&file), node_(&node), subject_(std::move(subject)) {}

  int line() const { return static_cast<int>(node_->source().begin.line); }
  const std::filesystem::path& file() const { return *file_; }
  /// "file:line: subject: message".
  [[noreturn]] void fail(const std::string& message) const { detail::fail(*file_, line(), subject_ + ": " + message); }

  bool is_text() const { return node_->is_string(); }
  bool is_integer() const { return node_->is_integer(); }
  bool is_flag() const { return node_->is_boolean(); }
  bool is_list() const { return node_->is_array(); }
  bool is_table() const { return node_->is_table(); }
  const toml::node& node() const { return *node_; }
  /// "expected three numbers, found a string".
  [[noreturn]] void fail_type(std::string_view expected) const;

  std::string text() const;
  bool flag() const;
  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  double number() const;  ///< finite
  double positive() const;
  double non_negative() const;
  double within(double low, double high) const;  ///< closed interval
  Vec3 vector() const;                           ///< three finite numbers
  Vec3 positive_vector() const;
  std::vector<Value> list() const;      ///< of an array
  Section section() const;              ///< of a table
  std::vector<Section> tables() const;  ///< of an array of tables; messages number them from 1

  /// One of the named choices.
  template <class Choice>
  Choice word(std::span<const std::pair<std::string_view, Choice>> choices) const {
    const std::string written = text();
    std::vector<std::string> names;
    for (const auto& [name, choice] : choices) {
      if (name == written) return choice;
      names.emplace_back(name);
    }
    fail("unknown word '" + written + "'" + suggestion(written, names));
  }

 private:
  double finite(const toml::node& node, std::string_view expected) const;

  const std::filesystem::path* file_;
  const toml::node* node_;
  std::string subject_;  ///< "body 'cup': velocity"
};

/// A key of a section and what reading it does to the target.
template <class Target>
struct Key {
  std::string_view name;
  void (*read)(const Value&, Target&);
  bool required = false;
};

template <class Target>
std::vector<std::string> key_names(std::span<const Key<Target>> keys) {
  std::vector<std::string> names;
  for (const Key<Target>& key : keys) names.emplace_back(key.name);
  return names;
}

/// A table of the file with the name that messages give it ("[scene]", "body 'cup'").
struct Section {
  const std::filesystem::path& file;
  const toml::table& table;
  std::string name;

  int line() const { return static_cast<int>(table.source().begin.line); }
  [[noreturn]] void fail(const std::string& message) const { detail::fail(file, line(), name + ": " + message); }
  /// Fails at the line of `key` if it is there, at the section's otherwise.
  [[noreturn]] void fail_at(std::string_view key, const std::string& message) const;
  bool has(std::string_view key) const { return table.contains(key); }
  /// Of a key that is there.
  Value value(std::string_view key) const { return {file, *table.get(key), name + ": " + std::string(key)}; }
};

/// Throws for a key of the section that is not among `known`.
void check_keys(const Section& section, const std::vector<std::string>& known);

/// Reads what the section has of `keys`, in the order of `keys`: a key may rely on what an earlier one set.
template <class Target>
void read_keys(const Section& section, std::span<const Key<Target>> keys, Target& target) {
  for (const Key<Target>& key : keys) {
    if (const toml::node* node = section.table.get(key.name)) {
      key.read(Value(section.file, *node, section.name + ": " + std::string(key.name)), target);
    } else if (key.required) {
      section.fail("missing key '" + std::string(key.name) + "'");
    }
  }
}

/// As `read_keys`, when the section may hold nothing else.
template <class Target>
void read_section(const Section& section, std::span<const Key<Target>> keys, Target& target) {
  check_keys(section, key_names(keys));
  read_keys(section, keys, target);
}

}  // namespace sunder::pipeline::detail
