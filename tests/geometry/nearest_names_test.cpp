#include "geometry/nearest_names.h"

#include <gtest/gtest.h>

namespace fascia {
namespace {

using Names = std::vector<std::string>;

TEST(NearestNames, AreThoseWithFewestLettersWrong) {
  const Names known = {"build", "bake", "batch", "info", "pose", "play"};
  EXPECT_EQ(nearest_names("bild", known), (Names{"build"}));
  EXPECT_EQ(nearest_names("posse", known), (Names{"pose"}));
  EXPECT_EQ(nearest_names("sculpt", known), Names());
  EXPECT_EQ(nearest_names("", known), Names());
}

TEST(NearestNames, ASwapOfNeighboursIsOneMistake) {
  EXPECT_EQ(nearest_names("paly", {"play", "pale"}), (Names{"play", "pale"}));
  EXPECT_EQ(nearest_names("ab", {"ba"}), (Names{"ba"}));
}

TEST(NearestNames, CaseAndSeparatorsDoNotCount) {
  EXPECT_EQ(nearest_names("Jaw-Open", {"jaw_lateral", "jaw_open"}), (Names{"jaw_open"}));
  EXPECT_EQ(nearest_names("MOUTHSMILE", {"arkit:mouthSmileLeft", "arkit:mouthSmileRight"}),
            (Names{"arkit:mouthSmileLeft", "arkit:mouthSmileRight"}));
}

TEST(NearestNames, APartOfANameFindsItButATypoIsNearer) {
  EXPECT_EQ(nearest_names("zygomaticus_major", {"zygomaticus_major_left", "zygomaticus_mejor"}),
            (Names{"zygomaticus_mejor", "zygomaticus_major_left"}));
}

TEST(NearestNames, AreAsManyAsAskedFor) {
  EXPECT_EQ(nearest_names("abcd", {"abce", "abcf", "abcg", "abch"}, 2), (Names{"abce", "abcf"}));
  EXPECT_EQ(nearest_names(std::string(100000, 'x'), {"x"}), Names()) << "no misspelt name is that long";
}

TEST(NearestNames, ReadAsAQuestion) {
  EXPECT_EQ(did_you_mean("abcd", {"abce", "abcf", "abcg"}), " (did you mean 'abce', 'abcf' or 'abcg'?)");
  EXPECT_EQ(did_you_mean("abcd", {"abce"}), " (did you mean 'abce'?)");
  EXPECT_EQ(did_you_mean("abcd", {"wxyz"}), "");
}

}  // namespace
}  // namespace fascia
