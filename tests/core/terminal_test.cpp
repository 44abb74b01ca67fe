#include <slipmode/core/terminal.hpp>

#include <gtest/gtest.h>

namespace slipmode {
namespace {

TEST(Terminal, ATextTakesARowAndNoMore) {
  EXPECT_EQ(row_of("sweep  1/9", 16), "sweep  1/9     ") << "15 characters: what a longer text left is overwritten";
  EXPECT_EQ(row_of("sweep  100/500   20 %", 16), "sweep  100/500 ");
  EXPECT_EQ(row_of("ΔX, Träger", 8), "ΔX, Trä") << "characters are counted, not bytes, and stay whole";
  EXPECT_EQ(row_of("x", 1), "");
}

TEST(Terminal, ProseIsBrokenBetweenWordsAndTablesAreNot) {
  EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
  EXPECT_EQ(wrapped("Dämpfung ΔX", 11), "Dämpfung ΔX") << "eleven characters in fourteen bytes";
  EXPECT_EQ(wrapped("unbreakable word", 4), "unbreakable\nword");
  EXPECT_EQ(wrapped_lines("one two three\n  column  column\nend\n", 7), "one two\nthree\n  column  column\nend\n");
}

}  // namespace
}  // namespace slipmode
