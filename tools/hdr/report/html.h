#pragma once
// Pieces of a page. Every text that a person or a file brought in passes escaped(); what is already HTML is called
// html.
#include <string>
#include <string_view>
#include <vector>

namespace hdr::report {

/// Text for an element or a quoted attribute: & < > " ' as entities. Bytes that are no UTF-8 (file names) become
/// U+FFFD, and so do characters that no page may hold.
std::string escaped(std::string_view text);

/// escaped(), and what stands between two backticks, a command, as <code>.
std::string with_code(std::string_view text);

/// <NAME>text</NAME>, the text escaped.
std::string element(std::string_view name, std::string_view text, std::string_view css_class = {});

/// A number for people: `digits` significant ones, a true minus sign, no exponent between 1e-4 and 1e6; NaN is a dash.
std::string number(double value, int digits = 3);
/// A time: 1/250 s, 2.5 s.
std::string seconds_text(double seconds);

/// Rows of text, with_code(), under a header; columns of numbers stand to the right.
class Table {
 public:
  struct Column {
    std::string title;
    bool numeric = false;
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell a column.
  void row(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Names with their values: the figures that matter, side by side.
class Facts {
 public:
  void add(std::string name, std::string value) { facts_.emplace_back(std::move(name), std::move(value)); }
  std::string html() const;

 private:
  std::vector<std::pair<std::string, std::string>> facts_;
};

/// A list of sentences; nothing when there are none.
std::string list(const std::vector<std::string>& sentences, std::string_view css_class = {});

/// <figure> around HTML with a caption of text; `wide`: the whole width of the page, else half of it where there is
/// room.
std::string figure(std::string_view html, std::string_view caption, bool wide = false);

}  // namespace hdr::report
