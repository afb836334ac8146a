// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <string>

#include "gpu-kernels/backend.h"

namespace windhover {

// The elements of one pipeline share one Backend through a GstContext of this type, as GStreamer's
// GL elements share their display. Its structure has the fields
//   "backend"       a boxed std::shared_ptr<Backend>
//   "device"        the text that it was made from (see Backend::Create)
//   "description"   its device, for people (see DeviceInfo::Describe)
// An application may make one itself and set it on the pipeline.
inline constexpr char kBackendContextType[] = "windhover.backend";

GstContext* MakeBackendContext(const std::shared_ptr<Backend>& backend, const std::string& device);
// Null where the context is of another type or empty.
std::shared_ptr<Backend> BackendOfContext(GstContext* context);

// One element's part in the sharing. Thread-safe.
class SharedBackend {
 public:
  explicit SharedBackend(GstElement* element) : element_(element) {}
  ~SharedBackend() { Forget(); }
  SharedBackend(const SharedBackend&) = delete;
  SharedBackend& operator=(const SharedBackend&) = delete;

  // The backend of this element from now on. Looks for a context: the one that was set before, then
  // the neighbours (CONTEXT query), then the application and the bins (need-context message). Where
  // there is none, makes a backend and offers it to the others (have-context message). An element
  // that names a device which the shared backend was not made for makes its own and keeps it
  // to itself. Throws DeviceError.
  std::shared_ptr<Backend> Acquire(const std::string& device);

  // For GstElementClass::set_context. Contexts of other types are ignored.
  void SetContext(GstContext* context);
  // Answers a CONTEXT query where it asks for what this element shares; false elsewhere.
  bool Answer(GstQuery* query);
  void Forget();

 private:
  bool Suits(const std::string& device);
  bool AskNeighbours(const std::string& device);

  GstElement* element_;
  std::mutex mutex_;
  GstContext* context_ = nullptr;
};

}  // namespace windhover
