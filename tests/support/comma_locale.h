// A locale with a decimal comma for as long as this lives, as a host program may have set one. Made by localedef (of
// the C library's own tools), since few machines that run tests have one installed.
#pragma once

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <string>

namespace livecap::test {

class CommaLocale {
 public:
  CommaLocale() : folder_(std::filesystem::temp_directory_path() / "livecap_comma_locale") {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "source") << "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3\n"
                                         "END LC_NUMERIC\n";
    const std::string make = "localedef -c -i '" + (folder_ / "source").string() + "' '" +
                             (folder_ / "commas").string() + "' >/dev/null 2>&1";
    [[maybe_unused]] const int warned = std::system(make.c_str());  // of the categories that it leaves out
    setenv("LOCPATH", folder_.c_str(), 1);
    is_set_ = std::setlocale(LC_NUMERIC, "commas") != nullptr;
    before_ = std::locale::global(std::locale(std::locale::classic(), new Commas));
  }
  ~CommaLocale() {
    std::locale::global(before_);
    std::setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
    std::filesystem::remove_all(folder_);
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  // False: printf and strtod keep their point, only streams have the comma.
  bool is_set() const { return is_set_; }

 private:
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::filesystem::path folder_;
  std::locale before_;
  bool is_set_ = false;
};

}  // namespace livecap::test

// Without localedef there is nothing to test with.
#define LIVECAP_COMMA_LOCALE_OR_SKIP(name) \
  const test::CommaLocale name;            \
  if (!name.is_set()) GTEST_SKIP() << "skipped: localedef made no locale with a decimal comma"
