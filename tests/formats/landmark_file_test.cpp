#include "formats/landmark_file.h"

#include <gtest/gtest.h>

#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::formats {
namespace {

LandmarkFile read_text(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / "fascia_landmarks_test.json";
  write_text(path, text);
  LandmarkFile file;
  try {
    file = read_landmarks(path);
  } catch (...) {
    std::filesystem::remove(path);
    throw;
  }
  std::filesystem::remove(path);
  return file;
}

TEST(LandmarkFile, ReadsThePlainFormWithAndWithoutBone) {
  const LandmarkFile file =
      read_text(R"({"units":"mm","landmarks":{"nasion":[1,2,3],"menton":{"skin":[4,5,6],"bone":[0,0,0]}}})");
  EXPECT_EQ(file.units, "mm");
  EXPECT_EQ(file.points.at("nasion"), Vec3(1, 2, 3));
  EXPECT_EQ(file.points.at("menton"), Vec3(4, 5, 6));
}

TEST(LandmarkFile, TurnsRasAndKeepsLps) {
  const char* form =
      R"({"markups":[{"coordinateSystem":"%","controlPoints":[{"label":"nasion","position":[1,2,3]}]}]})";
  std::string ras = form, lps = form;
  ras.replace(ras.find('%'), 1, "RAS");
  lps.replace(lps.find('%'), 1, "LPS");
  EXPECT_EQ(read_text(ras).points.at("nasion"), Vec3(-1, -2, 3));
  EXPECT_EQ(read_text(lps).points.at("nasion"), Vec3(1, 2, 3));
}

TEST(LandmarkFile, ReportsInvalidInput) {
  for (const char* text :
       {"", "[]", "{", R"({"landmarks":{}})", R"({"units":"ell","landmarks":{"a":[1,2,3]}})",
        R"({"markups":[{"controlPoints":[{"label":"a","position":[1,2,3],"positionStatus":1}]}]})",
        R"({"markups":[{"controlPoints":[{"label":"a","position":7,"positionStatus":null}]}]})",
        R"({"landmarks":{"a":[1,2]}})", R"({"landmarks":{"a":["x",2,3]}})", R"({"points":1})"})
    EXPECT_THROW(read_text(text), Error) << text;
}

}  // namespace
}  // namespace fascia::formats
