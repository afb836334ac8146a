// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "gpu-kernels/opencl/device.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::Not;

DeviceInfo MakeInfo(DeviceKind kind, const std::string& platform, const std::string& name) {
  DeviceInfo info;
  info.kind = kind;
  info.platform = platform;
  info.name = name;
  return info;
}

const std::vector<DeviceInfo> kDevices = {
    MakeInfo(DeviceKind::kOpenClGpu, "NVIDIA CUDA", "H200"),
    MakeInfo(DeviceKind::kOpenClGpu, "NVIDIA CUDA", "A100:40GB"),
    MakeInfo(DeviceKind::kOpenClGpu, "Intel(R) OpenCL", "Arc A770"),
    MakeInfo(DeviceKind::kOpenClCpu, "Intel(R) OpenCL", "Xeon 8480"),
    MakeInfo(DeviceKind::kOpenClCpu, "Portable Computing Language", "pthread-EPYC"),
    MakeInfo(DeviceKind::kOpenClOther, "Portable Computing Language", "ttasim"),
};

struct SelectorCase {
  const char* selector;
  std::optional<std::size_t> index;
};

void PrintTo(const SelectorCase& selector_case, std::ostream* out) {
  *out << '"' << selector_case.selector << '"';
}

class SelectDeviceTest : public testing::TestWithParam<SelectorCase> {};

TEST_P(SelectDeviceTest, FollowsTheGrammar) {
  EXPECT_EQ(opencl::SelectDevice(kDevices, GetParam().selector), GetParam().index)
      << GetParam().selector;
}

INSTANTIATE_TEST_SUITE_P(
    Selectors, SelectDeviceTest,
    testing::Values(SelectorCase{"", 0}, SelectorCase{"::", 0}, SelectorCase{":GPU:", 0},
                    SelectorCase{":CPU:", 3}, SelectorCase{":GPU:1", 1}, SelectorCase{":GPU:2", 2},
                    SelectorCase{":GPU:3", std::nullopt}, SelectorCase{":CPU:1", 4},
                    SelectorCase{"::5", 5}, SelectorCase{"Intel::", 2},
                    SelectorCase{"Intel:CPU:", 3}, SelectorCase{"Intel:CPU:0", 3},
                    SelectorCase{"intel:cpu:xeon", 3}, SelectorCase{"Intel", 2},
                    SelectorCase{"Portable:CPU", 4}, SelectorCase{":ACCELERATOR:", 5},
                    SelectorCase{":GPU:A100:40GB", 1}, SelectorCase{":CPU:H200", std::nullopt},
                    SelectorCase{"AMD::", std::nullopt}, SelectorCase{":TPU:", std::nullopt},
                    SelectorCase{"nonsense", std::nullopt},
                    SelectorCase{"::99999999999999999999", std::nullopt}));

TEST(SelectorOfTest, SelectsTheDeviceAndNoOther) {
  std::vector<DeviceInfo> devices = kDevices;
  for (const char* name : {"H200", "RTX 3080 Ti", "RTX 3080", "7"}) {
    devices.push_back(MakeInfo(DeviceKind::kOpenClGpu, "NVIDIA CUDA", name));
  }
  devices.push_back(MakeInfo(DeviceKind::kOpenClGpu, "NVIDIA", "RTX 3080"));
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(opencl::SelectDevice(devices, opencl::SelectorOf(devices, i)), i) << i;
  }
  EXPECT_EQ(opencl::SelectorOf(devices, 0), "NVIDIA CUDA:GPU:H200");
  EXPECT_EQ(opencl::SelectorOf(devices, 6), "NVIDIA CUDA:GPU:2");
  EXPECT_EQ(Backend::Create("cpu")->device().selector, "cpu");
}

TEST(DeviceInfoTest, DescribesItself) {
  EXPECT_EQ(kDevices[0].Describe(), "OpenCL GPU 'H200' (NVIDIA CUDA)");
  EXPECT_EQ(kDevices[5].Describe(), "OpenCL ACCELERATOR 'ttasim' (Portable Computing Language)");
  EXPECT_EQ(Backend::Create("cpu")->device().Describe(), "CPU twin");
}

class BackendTest : public testing::Test {
 protected:
  void SetUp() override { unsetenv("WINDHOVER_DEVICE"); }
  void TearDown() override { unsetenv("WINDHOVER_DEVICE"); }

  static std::string ErrorOf(const std::string& selector) {
    try {
      Backend::Create(selector);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(BackendTest, ListsOpenClDevicesAndThenTheCpuTwin) {
  const std::vector<DeviceInfo> devices = Backend::Devices();
  ASSERT_GE(devices.size(), 2u) << "these tests need an OpenCL device";
  EXPECT_EQ(devices.back().kind, DeviceKind::kCpuTwin);
  for (std::size_t i = 0; i + 1 < devices.size(); ++i) {
    EXPECT_NE(devices[i].kind, DeviceKind::kCpuTwin);
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_GT(devices[i].compute_units, 0);
    EXPECT_EQ(Backend::Create(devices[i].selector)->device().name, devices[i].name);
  }
}

TEST_F(BackendTest, TakesTheFirstOpenClDeviceByDefault) {
  EXPECT_EQ(Backend::Create()->device().selector, Backend::Devices().front().selector);
}

TEST_F(BackendTest, TakesTheEnvironmentsDeviceWhereNoneIsGiven) {
  setenv("WINDHOVER_DEVICE", "cpu", 1);
  EXPECT_EQ(Backend::Create()->device().kind, DeviceKind::kCpuTwin);
  const std::string open_cl = Backend::Devices().front().selector;
  EXPECT_EQ(Backend::Create(open_cl)->device().selector, open_cl);
  setenv("WINDHOVER_DEVICE", "no such:GPU:device", 1);
  EXPECT_THROW(Backend::Create(), DeviceError);
  EXPECT_EQ(Backend::Create("cpu")->device().kind, DeviceKind::kCpuTwin);
  setenv("WINDHOVER_DEVICE", "", 1);
  EXPECT_NE(Backend::Create()->device().kind, DeviceKind::kCpuTwin);
}

TEST_F(BackendTest, UnknownDeviceIsRefusedWithTheListOfDevices) {
  const std::string text = ErrorOf("no such:GPU:device");
  EXPECT_THAT(text, HasSubstr("'no such:GPU:device'"));
  for (const DeviceInfo& device : Backend::Devices()) EXPECT_THAT(text, HasSubstr(device.selector));
}

// In a process of its own, as the list of platforms is read once in each.
TEST(BackendDeathTest, FallsBackToTheCpuTwinWithOneWarningWhereThereIsNoPlatform) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        setenv("OCL_ICD_VENDORS", "/nonexistent/", 1);
        unsetenv("WINDHOVER_DEVICE");
        int warnings = 0;
        const auto backend = Backend::Create("", [&](const std::string&) { ++warnings; });
        const bool good = warnings == 1 && backend->device().kind == DeviceKind::kCpuTwin &&
                          Backend::Devices().size() == 1;
        std::exit(good ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

class MemoryTest : public OperatorTest {};

TEST_P(MemoryTest, IsAlignedAndKeepsWhatIsWritten) {
  for (const PictureSize size : kOddSizes) {
    const Picture picture = RandomPicture(size, 1);
    const GrayImage image = Upload(picture);
    EXPECT_TRUE(SamePicture(Download(image), picture));
    const auto first = image.Read();
    const auto second = image.Read();
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first.data()) % 64, 0u);
    EXPECT_EQ(first.at(0, 0), second.at(0, 0));
  }
}

TEST_P(MemoryTest, ImagesHaveRowsOfWholeCacheLines) {
  const auto image = backend().MakeImage<std::uint32_t>(17, 3);
  EXPECT_EQ(image.stride(), 32);
  const BitImage bits = backend().MakeBitImage(33, 3);
  EXPECT_EQ(bits.words.width(), 2);
  EXPECT_EQ(bits.words.stride(), 16);
}

TEST_P(MemoryTest, RefusesNothingAndFarTooMuch) {
  EXPECT_THROW(backend().Allocate(0), std::invalid_argument);
  EXPECT_THROW(backend().Allocate(std::size_t{1} << 60), DeviceError);
}

WINDHOVER_TEST_ON_ALL_BACKENDS(MemoryTest);

TEST(WarmUpTest, NamesEachKernelAndLeavesNothingToCompile) {
  std::vector<std::string> names;
  BackendNamed("OpenCl")->WarmUp([&](const std::string& name) { names.push_back(name); });
  EXPECT_GE(names.size(), 5u);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_THAT(names, Not(testing::Contains("")));
  BackendNamed("CpuTwin")->WarmUp([](const std::string&) { FAIL(); });
}

}  // namespace
}  // namespace windhover
