#include "cli/fit_output.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/picture.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

std::string number(double value, const char* format = "%.4f") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

bool in_use(const fit::Subject& subject, const fit::FitResult& result, size_t channel) {
  return std::abs(result.activations[channel] - subject.channels()[channel].rest) > 1e-3F;
}

/// A shape's name as a file's.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : name)
    word += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.' ? c : '_';
  return word;
}

std::vector<size_t> used_channels(const fit::Subject& subject, const std::vector<fit::FitResult>& results) {
  std::vector<size_t> used;
  for (size_t c = 0; c < subject.channels().size(); ++c)
    if (std::any_of(results.begin(), results.end(), [&](const auto& r) { return in_use(subject, r, c); }))
      used.push_back(c);
  if (used.empty() && !subject.channels().empty()) used.push_back(0);  // curves need a column
  return used;
}

std::string csv_of(const fit::Subject& subject, const std::vector<double>& times,
                   const std::vector<fit::FitResult>& results) {
  const std::vector<size_t> used = used_channels(subject, results);
  std::string text = "time";
  for (const size_t c : used)
    text += "," + subject.channels()[c].name;
  text += "\n";
  for (size_t f = 0; f < results.size(); ++f) {
    text += number(times[f], "%.6f");
    for (const size_t c : used)
      text += "," + number(static_cast<double>(results[f].activations[c]));
    text += "\n";
  }
  return text;
}

std::string curves_of(const fit::Subject& subject, const std::vector<double>& times,
                      const std::vector<fit::FitResult>& results) {
  nlohmann::ordered_json curves;
  for (const size_t c : used_channels(subject, results)) {
    nlohmann::ordered_json& curve = curves[subject.channels()[c].name];
    curve["times"] = times;
    for (const fit::FitResult& result : results)
      curve["values"].push_back(result.activations[c]);
  }
  return curves.dump(1) + "\n";
}

/// Blue at 0, green at 1 mm, red at 3 mm and above.
Vec3 heat(double mm) {
  const auto ramp = [](double x) { return std::clamp(x, 0.0, 1.0); };
  if (mm < 1.0) return {0.10, 0.25 + 0.60 * ramp(mm), 0.85 - 0.65 * ramp(mm)};
  return {0.10 + 0.80 * ramp(0.5 * (mm - 1.0)), 0.85 - 0.70 * ramp(0.5 * (mm - 1.0)), 0.20};
}

std::vector<double> residual_mm(const fit::Target& target, const fit::FitResult& result) {
  std::vector<double> list(target.confidence.size(), 0.0);
  for (size_t v = 0; v < list.size(); ++v)
    if (target.confidence[v] > 0.0)
      list[v] =
          1e3 *
          (result.displacements - target.displacements).segment<3>(static_cast<Eigen::Index>(3 * v)).norm();
  return list;
}

/// Surfaces of the rig's primitives with `displacements`, coloured by `mm` where that is given.
view::DrawList drawn(const fit::Subject& subject, const Eigen::VectorXd& displacements,
                     const std::vector<double>& mm) {
  view::DrawList list;
  for (size_t p = 0; p < subject.file().primitives.size(); ++p) {
    view::DrawSurface surface;
    surface.colour = Vec3(0.80, 0.64, 0.55);
    for (size_t v = subject.first_vertex(p); v < subject.first_vertex(p + 1); ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      surface.positions.push_back(subject.rest().segment<3>(at) + displacements.segment<3>(at));
      if (!mm.empty()) surface.vertex_colours.push_back(heat(mm[v]));
    }
    for (const rig::Triangle& t : subject.file().primitives[p].triangles)
      surface.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
    list.surfaces.push_back(std::move(surface));
  }
  return list;
}

void write_picture(const std::filesystem::path& path, const fit::Subject& subject, const fit::Target& target,
                   const fit::FitResult& result, const std::string& name) {
  const view::Renderer renderer(420, 420);
  const Bounds box = face_box(subject.file().rig);
  const std::vector<double> mm = residual_mm(target, result);
  std::vector<view::Tile> tiles;
  for (const char* view : {"front", "three-quarter"}) {
    const view::Camera camera = view::named_camera(view, box);
    tiles.push_back({renderer.draw(drawn(subject, target.displacements, {}), camera), "target: " + name});
    tiles.push_back({renderer.draw(drawn(subject, result.displacements, {}), camera), "fitted"});
    tiles.push_back(
        {renderer.draw(drawn(subject, result.displacements, mm), camera), "left: blue 0, green 1, red 3 mm"});
  }
  view::write_png(path, view::contact_sheet(tiles, 3));
}

/// The fitted surface in the input's axes and units, with the distance left at each vertex.
void write_residual_ply(const std::filesystem::path& path, const fit::Subject& subject,
                        const fit::Target& target, const fit::FitResult& result) {
  const std::vector<double> mm = residual_mm(target, result);
  const Mat4 back = subject.file().rig.input_to_metres.cast<double>().inverse();
  size_t triangles = 0;
  for (const rig::Primitive& primitive : subject.file().primitives)
    triangles += primitive.triangles.size();
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << mm.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
          "property uchar blue\nproperty float error_mm\nelement face "
       << triangles << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t v = 0; v < mm.size(); ++v) {
    const auto at = static_cast<Eigen::Index>(3 * v);
    const Vec3 place =
        transform_point(back, subject.rest().segment<3>(at) + result.displacements.segment<3>(at));
    const Vec3 colour = 255.0 * heat(mm[v]);
    text << number(place.x(), "%.7g") << ' ' << number(place.y(), "%.7g") << ' ' << number(place.z(), "%.7g")
         << ' ' << std::lround(colour.x()) << ' ' << std::lround(colour.y()) << ' ' << std::lround(colour.z())
         << ' ' << number(mm[v]) << '\n';
  }
  for (size_t p = 0; p < subject.file().primitives.size(); ++p)
    for (const rig::Triangle& t : subject.file().primitives[p].triangles)
      text << "3 " << subject.first_vertex(p) + t[0] << ' ' << subject.first_vertex(p) + t[1] << ' '
           << subject.first_vertex(p) + t[2] << '\n';
  formats::write_text(path, text.str());
}

std::string report_text(const fit::Subject& subject, const FitTargets& targets,
                        const std::vector<fit::FitResult>& results, size_t worst) {
  std::string text =
      "# Fit\n\n| target | share explained | error mm | rms mm | steps |\n|---|---|---|---|---|\n";
  for (size_t i = 0; i < results.size(); ++i)
    text += "| " + targets.names[i] + " | " + number(results[i].share, "%.3f") + " | " +
            number(results[i].error_mm, "%.3f") + " | " + number(results[i].rms_mm, "%.3f") + " | " +
            std::to_string(results[i].iterations) + " |\n";
  const fit::FitResult& result = results[worst];
  text += "\n## " + targets.names[worst] +
          "\n\nThe target explained worst; its residual is in residual.png and residual.ply.\n"
          "Spread: how far the activation may go, the others following, before the root mean square error "
          "rises by "
          "0.05 mm.\n\n| channel | activation | spread |\n|---|---|---|\n";
  for (size_t c = 0; c < result.activations.size(); ++c)
    if (in_use(subject, result, c))
      text += "| " + subject.channels()[c].name + " | " +
              number(static_cast<double>(result.activations[c]), "%.3f") + " | " +
              (result.spread.empty() ? "not estimated" : number(result.spread[c], "%.3f")) + " |\n";
  if (!result.alike.empty()) text += "\nHardly told apart by this target:\n\n";
  for (const auto& [a, b] : result.alike)
    text += "- " + subject.channels()[a].name + ", " + subject.channels()[b].name + "\n";
  return text;
}

}  // namespace

nlohmann::ordered_json fitted_activations(const fit::Subject& subject, const fit::FitResult& result) {
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  for (size_t c = 0; c < result.activations.size(); ++c)
    if (in_use(subject, result, c))
      values[subject.channels()[c].name] = std::round(1e5 * static_cast<double>(result.activations[c])) / 1e5;
  return values;
}

void add_certainty(const fit::Subject& subject, const fit::FitResult& result,
                   nlohmann::ordered_json& report) {
  if (result.spread.empty()) return;  // fitted by other means
  report["spread"] = nlohmann::ordered_json::object();
  for (size_t c = 0; c < result.spread.size(); ++c)
    if (in_use(subject, result, c)) report["spread"][subject.channels()[c].name] = result.spread[c];
  report["alike"] = nlohmann::ordered_json::array();
  for (const auto& [a, b] : result.alike)
    report["alike"].push_back({subject.channels()[a].name, subject.channels()[b].name});
}

void check_fit_output(const std::filesystem::path& path, const FitTargets& targets) {
  const std::string extension = extension_of(path);
  if (targets.kind == FitTargets::Kind::mesh && extension != ".json")
    throw Error("'" + path.string() + "': the activations of one mesh are written as .json");
  if (targets.kind == FitTargets::Kind::take && extension != ".csv" && extension != ".json")
    throw Error("'" + path.string() + "': the curves of a take are written as .csv or .json");
  if (targets.kind == FitTargets::Kind::shapes && !extension.empty() && extension != ".csv")
    throw Error(
        "'" + path.string() + "': the activations of " + std::to_string(targets.names.size()) +
        " shapes are written into a folder (a path without extension), one NAME.json each, or as one .csv; "
        "--shape NAME fits one of them");
}

void write_fit(const std::filesystem::path& path, const fit::Subject& subject, const FitTargets& targets,
               const std::vector<fit::FitResult>& results, double fps) {
  if (targets.kind == FitTargets::Kind::mesh) {
    formats::write_text(
        path,
        nlohmann::ordered_json{{"activations", fitted_activations(subject, results[0])}}.dump(2) + "\n");
    return;
  }
  if (targets.kind == FitTargets::Kind::shapes && path.extension().empty()) {
    formats::PartialGroup together;
    make_output_folder(path, &together);
    std::set<std::string> words;
    for (size_t i = 0; i < results.size(); ++i) {
      std::string word = file_word(targets.names[i]);
      if (!words.insert(word).second) words.insert(word += "_" + std::to_string(i));
      const std::filesystem::path file = path / (word + ".json");
      together.add(file);
      formats::write_text(
          file,
          nlohmann::ordered_json{{"activations", fitted_activations(subject, results[i])}}.dump(2) + "\n");
    }
    together.keep();
    return;
  }
  std::vector<double> times = targets.times;
  for (size_t i = times.size(); i < results.size(); ++i)
    times.push_back(static_cast<double>(i) / fps);
  formats::write_text(path, extension_of(path) == ".csv" ? csv_of(subject, times, results)
                                                         : curves_of(subject, times, results));
}

std::vector<std::filesystem::path> fit_report_files(const std::filesystem::path& folder) {
  return {folder / "residual.png", folder / "residual.ply", folder / "report.md"};
}

void write_fit_report(const std::filesystem::path& folder, const fit::Subject& subject,
                      const FitTargets& targets, const std::vector<fit::FitResult>& results) {
  size_t worst = 0;
  for (size_t i = 1; i < results.size(); ++i)
    if (results[i].rms_mm > results[worst].rms_mm) worst = i;
  const fit::Target target = targets.target(worst);
  const std::vector<std::filesystem::path> files = fit_report_files(folder);
  formats::PartialGroup together;
  for (const std::filesystem::path& file : files)
    together.add(file);
  write_picture(files[0], subject, target, results[worst], targets.names[worst]);
  write_residual_ply(files[1], subject, target, results[worst]);
  formats::write_text(files[2], report_text(subject, targets, results, worst));
  together.keep();
}

}  // namespace fascia::cli
