// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/voc_annotation.h"

#include <glib.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

// What has been read of the object that is open.
struct OpenObject {
  std::string name;
  std::optional<double> left, top, right, bottom;
  bool occluded = false;
  bool truncated = false;
  bool difficult = false;
};

struct Reading {
  VocAnnotation annotation;
  OpenObject object;
  std::string element;   // names from the root to the open element, each after a '/'
  std::string text;      // of the innermost open element
  gint line = 1;         // where the last text ended: the parser itself is a character further
  bool refused = false;  // the XML is well-formed; what it says is not
};

void Complain(Reading& reading, GError** error, const std::string& reason) {
  reading.refused = true;
  g_set_error_literal(error, G_MARKUP_ERROR, G_MARKUP_ERROR_INVALID_CONTENT, reason.c_str());
}

std::optional<double> Number(Reading& reading, GError** error) {
  const std::optional<double> value = ParseNumber(reading.text);
  if (!value) {
    Complain(reading, error,
             reading.element.substr(reading.element.rfind('/') + 1) + " is no number: '" +
                 reading.text + "'");
  }
  return value;
}

void ReadSide(Reading& reading, int& side, GError** error) {
  const std::optional<double> value = Number(reading, error);
  if (!value) return;
  if (*value != std::floor(*value) || *value < 0 || *value > 1e6) {
    Complain(reading, error, "the picture's size must be whole and from 0");
    return;
  }
  side = static_cast<int>(*value);
}

void CloseObject(Reading& reading, GError** error) {
  const OpenObject& object = reading.object;
  if (!object.left || !object.top || !object.right || !object.bottom) {
    Complain(reading, error, "an object lacks xmin, ymin, xmax or ymax");
    return;
  }
  const Box box = {*object.left, *object.top, *object.right - *object.left,
                   *object.bottom - *object.top};
  if (box.width <= 0 || box.height <= 0) {
    Complain(reading, error, "xmax and ymax must be above xmin and ymin");
    return;
  }
  reading.annotation.objects.push_back(
      {object.name, box, object.occluded, object.truncated, object.difficult});
}

void TakeElement(Reading& reading, GError** error) {
  const std::string_view element = reading.element;
  OpenObject& object = reading.object;
  if (element == "/annotation/size/width") ReadSide(reading, reading.annotation.width, error);
  if (element == "/annotation/size/height") ReadSide(reading, reading.annotation.height, error);
  if (element == "/annotation/object") CloseObject(reading, error);
  if (element == "/annotation/object/name") object.name = reading.text;
  if (element == "/annotation/object/occluded") object.occluded = reading.text == "1";
  if (element == "/annotation/object/truncated") object.truncated = reading.text == "1";
  if (element == "/annotation/object/difficult") object.difficult = reading.text == "1";
  if (element == "/annotation/object/bndbox/xmin") object.left = Number(reading, error);
  if (element == "/annotation/object/bndbox/ymin") object.top = Number(reading, error);
  if (element == "/annotation/object/bndbox/xmax") object.right = Number(reading, error);
  if (element == "/annotation/object/bndbox/ymax") object.bottom = Number(reading, error);
}

void OnStart(GMarkupParseContext*, const gchar* name, const gchar**, const gchar**, gpointer data,
             GError** error) {
  Reading& reading = *static_cast<Reading*>(data);
  reading.element += '/';
  reading.element += name;
  reading.text.clear();
  if (reading.element == "/annotation/object") reading.object = {};
  if (reading.element.find('/', 1) == std::string::npos && reading.element != "/annotation") {
    Complain(reading, error,
             "is no annotation: the outermost element is '" + std::string(name) + "'");
  }
}

void OnEnd(GMarkupParseContext*, const gchar*, gpointer data, GError** error) {
  Reading& reading = *static_cast<Reading*>(data);
  reading.text = std::string(Trimmed(reading.text));
  TakeElement(reading, error);
  reading.element.resize(reading.element.rfind('/'));
  reading.text.clear();
}

void OnText(GMarkupParseContext* context, const gchar* text, gsize length, gpointer data,
            GError**) {
  Reading& reading = *static_cast<Reading*>(data);
  reading.text.append(text, length);
  g_markup_parse_context_get_position(context, &reading.line, nullptr);
}

// GLib's own complaints begin with the place, which FormatError names already.
std::string Reason(const GError& error) {
  const std::string text = error.message;
  const std::size_t colon = text.find(": ");
  return text.rfind("Error on line", 0) == 0 && colon != std::string::npos ? text.substr(colon + 2)
                                                                           : text;
}

}  // namespace

VocAnnotation ReadVoc(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FormatError(file, "cannot be read");
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  static constexpr GMarkupParser kParser = {OnStart, OnEnd, OnText, nullptr, nullptr};
  Reading reading;
  const std::unique_ptr<GMarkupParseContext, decltype(&g_markup_parse_context_unref)> context(
      g_markup_parse_context_new(&kParser, static_cast<GMarkupParseFlags>(0), &reading, nullptr),
      g_markup_parse_context_unref);
  GError* error = nullptr;
  if (g_markup_parse_context_parse(context.get(), content.data(),
                                   static_cast<gssize>(content.size()), &error) == FALSE ||
      g_markup_parse_context_end_parse(context.get(), &error) == FALSE) {
    const std::unique_ptr<GError, decltype(&g_error_free)> owned(error, g_error_free);
    gint line = reading.line;
    if (!reading.refused) g_markup_parse_context_get_position(context.get(), &line, nullptr);
    throw FormatError(file, static_cast<std::size_t>(line), Reason(*error));
  }
  return std::move(reading.annotation);
}

}  // namespace windhover::replay
