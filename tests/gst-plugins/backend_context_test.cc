// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/backend_context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/difference_threshold/difference_threshold.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "gpu-kernels/temporal_median/temporal_median.h"
#include "gpu-kernels/warp/warp.h"
#include "tests/gst-plugins/harness.h"

namespace windhover {
namespace {

std::shared_ptr<Backend> BackendOf(GstElement* element) {
  GstContext* context = gst_element_get_context(element, kBackendContextType);
  if (context == nullptr) return nullptr;
  const auto backend = BackendOfContext(context);
  gst_context_unref(context);
  return backend;
}

// The backend of the element of that name.
std::shared_ptr<Backend> BackendOf(const ElementPtr& pipeline, const char* name) {
  GstElement* element = gst_bin_get_by_name(GST_BIN(pipeline.get()), name);
  const auto backend = BackendOf(element);
  gst_object_unref(element);
  return backend;
}

GstStateChangeReturn Pause(const ElementPtr& element) {
  return gst_element_set_state(element.get(), GST_STATE_PAUSED);
}

TEST(BackendContext, HoldsTheBackend) {
  const auto backend = Backend::Create("cpu");
  GstContext* context = MakeBackendContext(backend, "cpu");
  EXPECT_EQ(BackendOfContext(context), backend);
  const GstStructure* fields = gst_context_get_structure(context);
  EXPECT_STREQ(gst_structure_get_string(fields, "device"), "cpu");
  EXPECT_EQ(gst_structure_get_string(fields, "description"), backend->device().Describe());
  gchar* text = gst_structure_to_string(fields);
  EXPECT_THAT(text, testing::HasSubstr("(GstWindhoverBackend)\"CPU\\ twin\""))
      << "gst-launch-1.0 prints it";
  g_free(text);
  gst_context_unref(context);

  GstContext* other = gst_context_new("another.kind", TRUE);
  EXPECT_EQ(BackendOfContext(other), nullptr);
  gst_context_unref(other);
  GstContext* empty = gst_context_new(kBackendContextType, TRUE);
  EXPECT_EQ(BackendOfContext(empty), nullptr);
  gst_context_unref(empty);
}

TEST(BackendContext, OnePipelineSharesOneBackend) {
  const ElementPtr pipeline =
      MakePipeline("whregister name=a device=cpu ! whbackground name=b device=cpu ! fakesink");
  const ElementPtr other =
      MakePipeline("whregister name=a device=cpu ! whbackground name=b device=cpu ! fakesink");
  Pause(pipeline);
  Pause(other);
  ASSERT_NE(BackendOf(pipeline, "a"), nullptr);
  EXPECT_EQ(BackendOf(pipeline, "a"), BackendOf(pipeline, "b"));
  EXPECT_NE(BackendOf(pipeline, "a"), BackendOf(other, "a"));
}

TEST(BackendContext, SharedAcrossOtherElementsAndByEmptyDevice) {
  const ElementPtr pipeline = MakePipeline(
      "whregister name=a ! queue ! identity ! whbackground name=b device=cpu ! fakesink");
  Pause(pipeline);
  ASSERT_NE(BackendOf(pipeline, "a"), nullptr);
  EXPECT_EQ(BackendOf(pipeline, "a"), BackendOf(pipeline, "b"));
}

TEST(BackendContext, NeighboursAnswerWithoutABin) {
  const ElementPtr first = MakeElement("whregister");
  const ElementPtr second = MakeElement("whbackground");
  for (const ElementPtr& element : {std::cref(first), std::cref(second)}) {
    g_object_set(element.get(), "device", "cpu", nullptr);
  }
  ASSERT_TRUE(gst_element_link(first.get(), second.get()));
  Pause(second);
  Pause(first);
  ASSERT_NE(BackendOf(first.get()), nullptr);
  EXPECT_EQ(BackendOf(first.get()), BackendOf(second.get()));
}

TEST(BackendContext, ApplicationsMaySetOne) {
  const auto backend = Backend::Create("cpu");
  const ElementPtr pipeline = MakePipeline("whregister name=a ! whbackground name=b ! fakesink");
  GstContext* context = MakeBackendContext(backend, "cpu");
  gst_element_set_context(pipeline.get(), context);
  gst_context_unref(context);
  Pause(pipeline);
  EXPECT_EQ(BackendOf(pipeline, "a"), backend);
  EXPECT_EQ(BackendOf(pipeline, "b"), backend);
}

// A device that nobody computes on.
class PretendedBackend : public Backend {
 public:
  PretendedBackend() {
    device_.kind = DeviceKind::kOpenClGpu;
    device_.name = "idle";
    device_.selector = "pretended:GPU:idle";
  }
  const DeviceInfo& device() const override { return device_; }
  std::unique_ptr<Memory> Allocate(std::size_t) override { return nullptr; }
  std::unique_ptr<Decimate> MakeDecimate() override { return nullptr; }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override { return nullptr; }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(const PhaseCorrelationSettings&) override {
    return nullptr;
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override { return nullptr; }
  std::unique_ptr<Warp> MakeWarp() override { return nullptr; }
  void WarmUp(const std::function<void(const std::string&)>&) override {}

 private:
  DeviceInfo device_;
};

TEST(SharedBackend, AnotherDeviceMakesItsOwn) {
  const ElementPtr element = MakeElement("fakesink");
  const auto shared = std::make_shared<PretendedBackend>();
  SharedBackend part(element.get());
  GstContext* context = MakeBackendContext(shared, "pretended:GPU:");
  part.SetContext(context);
  gst_context_unref(context);
  EXPECT_EQ(part.Acquire(""), shared);
  EXPECT_EQ(part.Acquire("pretended:GPU:"), shared);
  EXPECT_EQ(part.Acquire("pretended:GPU:idle"), shared) << "its device's own selector";
  const auto own = part.Acquire("cpu");
  EXPECT_NE(own, shared);
  EXPECT_EQ(own->device().selector, "cpu");
  EXPECT_THROW(part.Acquire("no such:GPU:device"), DeviceError);
  EXPECT_EQ(part.Acquire(""), shared) << "others of the pipeline still share it";
  EXPECT_EQ(BackendOf(element.get()), nullptr) << "the own one is offered to nobody";
}

TEST(BackendContext, UnknownDeviceIsAnError) {
  const ElementPtr pipeline = MakePipeline("whregister device=nowhere:GPU:none ! fakesink");
  EXPECT_EQ(Pause(pipeline), GST_STATE_CHANGE_FAILURE);
  GstBus* bus = gst_element_get_bus(pipeline.get());
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  ASSERT_NE(message, nullptr);
  GError* error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  EXPECT_TRUE(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND));
  EXPECT_THAT(error->message, testing::HasSubstr("nowhere:GPU:none"));
  EXPECT_THAT(error->message, testing::HasSubstr("cpu")) << "says what there is";
  g_clear_error(&error);
  gst_message_unref(message);
  gst_object_unref(bus);
}

}  // namespace
}  // namespace windhover
