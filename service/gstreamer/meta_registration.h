// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <new>

namespace windhover {

// Names and functions of a GstMeta whose struct is `Meta`.
struct MetaDescription {
  const char* api_name;
  const char* info_name;
  const char** tags;  // ends with null
  GstMetaTransformFunction transform;
};

// Several modules of one process may hold this code: whichever comes first registers, the others
// use what is there. `Describe` is a function that returns the MetaDescription.
template <typename Meta, auto Describe>
struct MetaRegistration {
  static GType Api() {
    static const GType type = [] {
      const MetaDescription description = Describe();
      const GType known = g_type_from_name(description.api_name);
      return known != 0 ? known
                        : gst_meta_api_type_register(description.api_name, description.tags);
    }();
    return type;
  }

  static const GstMetaInfo* Info() {
    static const GstMetaInfo* const info = [] {
      const MetaDescription description = Describe();
      const GstMetaInfo* known = gst_meta_get_info(description.info_name);
      return known != nullptr ? known
                              : gst_meta_register(Api(), description.info_name, sizeof(Meta), Init,
                                                  Free, description.transform);
    }();
    return info;
  }

  static Meta* Of(GstBuffer* buffer) {
    return reinterpret_cast<Meta*>(gst_buffer_get_meta(buffer, Api()));
  }

 private:
  // GStreamer places the header at multiples of 16 bytes.
  static_assert(alignof(Meta) <= 16);

  static gboolean Init(GstMeta* meta, gpointer, GstBuffer*) {
    const GstMeta header = *meta;
    auto* made = new (meta) Meta{};
    made->meta = header;
    return TRUE;
  }
  static void Free(GstMeta* meta, GstBuffer*) { std::destroy_at(reinterpret_cast<Meta*>(meta)); }
};

}  // namespace windhover
