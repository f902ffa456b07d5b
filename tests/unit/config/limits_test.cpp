// SPDX-License-Identifier: Apache-2.0
#include "common/base/units.hpp"
#include "common/config/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::limits_test {
using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
  return support::error_of([&] { config::Document::parse(text, "case.yaml"); });
}

TEST(Limits, anchors_that_multiply_are_refused_before_they_fill_the_memory) {
  std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 10; ++i) bomb += (i > 0 ? ", *" : "*") + std::string(1, char(c - 1));
    bomb += "]\n";
  }
  EXPECT_THAT(error_of(bomb), HasSubstr("more than 1000000 values"));
  EXPECT_EQ(error_of("a: &a [1, 2]\nb: *a\n"), "");
}

TEST(Limits, control_characters_are_refused_with_their_place) {
  EXPECT_EQ(error_of("a: 1\n\"b\\x07\": 2\n"),
            "case.yaml:2:1: this key contains a control character (code 7); remove it.");
  EXPECT_THAT(error_of("a: \"\\e[31mred\"\n"),
              HasSubstr("a: this value contains a control character (code 27)"));
  EXPECT_THAT(error_of("a: \"\\x9b31mred\"\n"),
              HasSubstr("a: this value contains a control character (code 155)"));
  EXPECT_EQ(error_of("a: \"two\\nlines\\tand a tab, \xc2\xb5m\"\n"), "");
}

TEST(Limits, names_are_in_one_line) {
  EXPECT_EQ(error_of("\"two\\nlines\": 1\n"),
            "case.yaml:1:1: this key contains a control character (code 10); remove it.");
  std::string name;
  std::vector<std::string> names;
  EXPECT_THAT(
      config::load(config::Document::parse("name: \"x\\ntouch PWNED\"\nnames: [a, \"b\\tc\"]\n", "case.yaml"),
                   "",
                   [&](config::Section& s) {
                     s.value("name", name);
                     s.value("names", names);
                   }),
      ElementsAre(HasSubstr("name: expected a single line of text"),
                  HasSubstr("entry 2 of the list: expected a single line of text")));
}

TEST(Limits, what_is_not_utf8_is_refused_with_its_place) {
  EXPECT_EQ(error_of("a: 1\nH\xf6he: 2\n"),
            "case.yaml:2:2: the byte 0xf6 is not text in UTF-8; save the file in this encoding.");
  for (const char* text : {"a: \x80", "a: \xc0\xaf", "a: \xe2\x82", "a: \xff\xfe", "a: \xf5\x80\x80\x80"})
    EXPECT_THAT(error_of(text), HasSubstr("case.yaml:1:4: the byte")) << text;
  EXPECT_EQ(error_of("H\xc3\xb6he: \xe2\x82\xac \xf0\x9f\x98\x80\n"), "");
}

TEST(Limits, brackets_in_units_are_counted) {
  EXPECT_EQ(base::parse_unit("((m))").factor, 1);
  EXPECT_THROW(base::parse_unit(std::string(19000, '(') + "m" + std::string(19000, ')')), Error);
}

struct Limited {
  int dimension = 2;
  config::ExpressionText load{"0"};
  std::vector<config::ExpressionText> velocity;
};

std::vector<std::string> load(const std::string& text) {
  Limited p;
  return config::load(
      config::Document::parse(text, "case.yaml"), "",
      [&](config::Section& s) {
        s.value("dimension", p.dimension);
        s.section(
            "flow",
            [&](config::Section& f) {
              f.value("load", p.load).unit("Pa");
              f.value("velocity", p.velocity).unit("m/s");
            },
            "");
      },
      [](const config::ExpressionText& e) {
        return e.text.find('Y') == std::string::npos ? "" : "unknown name 'Y'.";
      });
}

TEST(Limits, expressions_are_checked_where_they_are_read) {
  EXPECT_THAT(load("flow: {load: 6*Y, velocity: [0, y*Y]}\n"),
              ElementsAre("case.yaml:1:8: flow.load: unknown name 'Y'.",
                          "case.yaml:1:19: flow.velocity: entry 2 of the list: unknown name 'Y'."));
  EXPECT_THAT(
      load("dimension: 3\nflow: {velocity: [0, 1]}\n"),
      ElementsAre(
          "case.yaml:2:8: flow.velocity: 2 components are given, but the 3-dimensional case needs 3."));
  EXPECT_THAT(load("dimension: 2\nflow: {load: -10 MPa, velocity: [2 km/h, 0]}\n"), testing::IsEmpty());
}

TEST(Limits, many_unknown_keys_are_counted_not_listed) {
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "unknown-" + std::to_string(i) + ": 1\n";
  const std::vector<std::string> messages = load(text);
  EXPECT_EQ(messages.size(), 21u);
  EXPECT_THAT(messages, testing::Contains(HasSubstr("19980 more unknown keys follow.")));
}

TEST(Limits, an_override_makes_the_section_that_is_not_there) {
  config::Document document = config::Document::parse("dimension: 2\nflow: {}\n", "case.yaml");
  document.set("flow.load=3");
  document.set("flow.more.deep=1");
  EXPECT_EQ(config::text_of(document, "flow.load"), "3");
  EXPECT_EQ(config::text_of(document, "flow.more.deep"), "1");
}

}  // namespace couplet::limits_test
