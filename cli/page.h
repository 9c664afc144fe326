#pragma once

#include <string>
#include <vector>

#include "view/image.h"

/// Pages of HTML that need nothing beside them.
namespace fascia::cli::page {

/// `digits` after the point.
std::string number(double value, int digits = 1);

/// A row of a table; `cells` are HTML, right-aligned from number `first_number` on. `tag`: td or th.
std::string row(const std::vector<std::string>& cells, const char* tag = "td", size_t first_number = 1);

/// A picture within the page; `about` stands where it cannot be shown.
std::string picture(const view::Image& image, const std::string& about);

/// The whole page; `title` is text, `body` HTML.
std::string whole(const std::string& title, const std::string& body);

}  // namespace fascia::cli::page
