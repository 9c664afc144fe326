#include "cli/page.h"

#include <cstdint>
#include <cstdio>

#include "geometry/base64.h"
#include "geometry/text.h"

namespace fascia::cli::page {

namespace {

const char* const style =
    "body{font:15px/1.5 sans-serif;max-width:1440px;margin:2em auto;padding:0 1em;color:#222;background:#fff}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}table{border-collapse:collapse}"
    "td,th{padding:.15em .8em;text-align:left;border-bottom:1px solid #ddd}td.n,th.n{text-align:right;"
    "font-variant-numeric:tabular-nums}.views{display:flex;flex-wrap:wrap;gap:6px}.views "
    "img{max-width:32%;height:auto}"
    ".warn{background:#fff3d6;border-left:4px solid #d98e00;padding:.4em 1em}.far{color:#b3361b}"
    ".bar{display:inline-block;height:.8em;background:#4a78a8}p.cap{color:#555;margin:.2em 0 .6em}";

}  // namespace

std::string number(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string row(const std::vector<std::string>& cells, const char* tag, size_t first_number) {
  std::string out = "<tr>";
  for (size_t i = 0; i < cells.size(); ++i)
    out += std::string("<") + tag + (i >= first_number ? " class=n>" : ">") + cells[i] + "</" + tag + ">";
  return out + "</tr>\n";
}

std::string picture(const view::Image& image, const std::string& about) {
  return "<img alt=\"" + escaped_markup(about) + "\" src=\"data:image/png;base64," +
         to_base64(view::encode_png(image)) + "\">";
}

std::string whole(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>" + escaped_markup(title) +
         "</title>\n<style>" + style + "</style></head>\n<body>\n<h1>" + escaped_markup(title) + "</h1>\n" +
         body + "</body></html>\n";
}

}  // namespace fascia::cli::page
