// SPDX-License-Identifier: Apache-2.0
// The OpenCL layer: error texts, kernels with typed arguments, the cache of compiled programs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/opencl_backend.h"
#include "gpu-kernels/opencl/program_cache.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "gpu-kernels/temporal_median/temporal_median.h"
#include "gpu-kernels/warp/warp.h"

namespace windhover::opencl {
namespace {

using testing::HasSubstr;

constexpr char kAddCl[] =
    "#line 1 \"add.cl\"\n"
    "__kernel void Add(__global int* values, int summand, float factor) {\n"
    "  const int i = get_global_id(0);\n"
    "  values[i] = (int)((values[i] + summand) * factor);\n"
    "}\n";
constexpr char kBrokenCl[] =
    "#line 1 \"broken.cl\"\n"
    "__kernel void Broken(__global int* values) {\n"
    "  values[0] = undeclared;\n"
    "}\n";

class TemporaryFolder {
 public:
  TemporaryFolder() {
    char name[] = "/tmp/windhover-opencl-test-XXXXXX";
    path_ = mkdtemp(name);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

  std::vector<std::filesystem::path> Files() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    return files;
  }

 private:
  std::filesystem::path path_;
};

std::string ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

class OpenClTest : public testing::Test {
 protected:
  OpenClTest() {
    const std::vector<Device> devices = ListDevices();
    if (devices.empty()) throw std::runtime_error("these tests need an OpenCL device");
    device_ = devices.front();
    context_ = MakeContext();
  }

  std::shared_ptr<Context> MakeContext() const {
    return std::make_shared<Context>(device_, ProgramCache(folder_.path() / "cache"));
  }

  // What (41 + 1) * 2 is on the device.
  static int Compute(Context& context, const Program& program) {
    Queue queue(context);
    const auto values = context.Allocate(sizeof(cl_int));
    cl_int value = 41;
    queue.EnqueueWrite(*values, &value, sizeof(value));
    Kernel<GlobalMemory, cl_int, cl_float>(program, "Add").Enqueue(queue, {}, *values, 1, 2.0F);
    queue.Read(*values, &value, sizeof(value));
    return value;
  }

  const TemporaryFolder folder_;
  Device device_;
  std::shared_ptr<Context> context_;
};

TEST_F(OpenClTest, RunsAKernel) { EXPECT_EQ(Compute(*context_, context_->Compile(kAddCl)), 84); }

TEST_F(OpenClTest, ErrorsNameDeviceCallAndCode) {
  const std::string text = ErrorOf([&] { context_->Allocate(std::size_t{1} << 60); });
  EXPECT_THAT(text, HasSubstr(device_.info.name));
  EXPECT_THAT(text, HasSubstr("clCreateBuffer"));
  EXPECT_THAT(text, HasSubstr("CL_"));
  EXPECT_EQ(CodeName(CL_OUT_OF_RESOURCES), "CL_OUT_OF_RESOURCES");
  EXPECT_EQ(CodeName(-9999), "OpenCL error -9999");
}

TEST_F(OpenClTest, CompilerMessagesNameFileAndLine) {
  const std::string text = ErrorOf([&] { context_->Compile(kBrokenCl); });
  EXPECT_THAT(text, HasSubstr("broken.cl:2"));
  EXPECT_THAT(text, HasSubstr("undeclared"));
  EXPECT_THAT(text, HasSubstr(device_.info.name));
}

TEST_F(OpenClTest, KernelsAreCheckedAgainstTheirProgram) {
  const Program program = context_->Compile(kAddCl);
  EXPECT_THAT(ErrorOf([&] { Kernel<GlobalMemory>(program, "Subtract"); }), HasSubstr("Subtract"));
  EXPECT_THAT(ErrorOf([&] { Kernel<GlobalMemory>(program, "Add"); }),
              HasSubstr("takes 3 arguments"));
}

TEST_F(OpenClTest, BadLaunchIsADeviceError) {
  const Program program = context_->Compile(kAddCl);
  Queue queue(*context_);
  const auto values = context_->Allocate(64);
  const Kernel<GlobalMemory, cl_int, cl_float> add(program, "Add");
  const WorkSize no_multiple = {.global = {3, 1, 1}, .local = {2, 1, 1}};
  EXPECT_THAT(ErrorOf([&] { add.Enqueue(queue, no_multiple, *values, 1, 1.0F); }),
              HasSubstr("clEnqueueNDRangeKernel"));
  const Kernel<GlobalMemory, cl_int, cl_double> wrong_size(program, "Add");
  EXPECT_THAT(ErrorOf([&] { wrong_size.Enqueue(queue, {}, *values, 1, 1.0); }),
              HasSubstr("clSetKernelArg 2"));
}

TEST_F(OpenClTest, MemoryOfAnotherBackendIsRefused) {
  const Program program = context_->Compile(kAddCl);
  Queue queue(*context_);
  const Kernel<GlobalMemory, cl_int, cl_float> add(program, "Add");
  const auto elsewhere = MakeContext()->Allocate(64);
  EXPECT_THROW(add.Enqueue(queue, {}, *elsewhere, 1, 1.0F), std::invalid_argument);
  const auto host = Backend::Create("cpu")->Allocate(64);
  EXPECT_THROW(add.Enqueue(queue, {}, *host, 1, 1.0F), std::invalid_argument);
}

TEST_F(OpenClTest, ObjectsOutliveTheirContext) {
  const Program program = context_->Compile(kAddCl);
  Queue queue(*context_);
  const auto values = context_->Allocate(sizeof(cl_int));
  context_.reset();
  cl_int value = 1;
  queue.EnqueueWrite(*values, &value, sizeof(value));
  Kernel<GlobalMemory, cl_int, cl_float>(program, "Add").Enqueue(queue, {}, *values, 1, 1.0F);
  queue.Finish();
  std::byte* bytes = values->Map(Access::kRead);
  EXPECT_EQ(*reinterpret_cast<cl_int*>(bytes), 2);
  values->Unmap(bytes);
}

TEST_F(OpenClTest, CompilesOnceAndThenReadsTheCache) {
  EXPECT_FALSE(context_->Compile(kAddCl).from_cache);
  EXPECT_EQ(folder_.Files().size(), 1u);
  EXPECT_EQ(context_->Compile(kAddCl).handle.get(), context_->Compile(kAddCl).handle.get());

  const auto next = MakeContext();
  const Program cached = next->Compile(kAddCl);
  EXPECT_TRUE(cached.from_cache);
  EXPECT_EQ(Compute(*next, cached), 84);
  EXPECT_FALSE(next->Compile(kAddCl, "-DANYTHING=1").from_cache);
  EXPECT_EQ(folder_.Files().size(), 2u);
}

TEST_F(OpenClTest, StoredAfterRunningItStillRuns) {
  EXPECT_EQ(Compute(*context_, context_->Compile(kAddCl)), 84);
  context_->StorePrograms();
  const auto next = MakeContext();
  const Program cached = next->Compile(kAddCl);
  EXPECT_TRUE(cached.from_cache);
  EXPECT_EQ(Compute(*next, cached), 84);
}

// The work that a driver has put off to the first launch is in the binary, too.
TEST_F(OpenClTest, WhatIsStoredAfterRunningHoldsMore) {
  // Options of its own, as PoCL itself remembers what it has compiled in earlier runs.
  const std::string options = "-DRUN=" + folder_.path().filename().string();
  EXPECT_EQ(Compute(*context_, context_->Compile(kAddCl, options)), 84);
  ASSERT_EQ(folder_.Files().size(), 1u);
  const auto before = std::filesystem::file_size(folder_.Files().front());
  context_->StorePrograms();
  ASSERT_EQ(folder_.Files().size(), 1u);
  EXPECT_GT(std::filesystem::file_size(folder_.Files().front()), before);
}

TEST_F(OpenClTest, WarmUpLeavesNothingToCompile) {
  const ProgramCache cache(folder_.path() / "cache");
  MakeOpenClBackend(device_, cache)->WarmUp({});
  const std::size_t warm = folder_.Files().size();
  EXPECT_GE(warm, 5u);
  const auto backend = MakeOpenClBackend(device_, cache);
  const GrayImage source = [&] {
    GrayImage image = backend->MakeImage<std::uint8_t>(160, 120);
    const auto mapped = image.Write();
    std::fill_n(mapped.data(), mapped.stride() * mapped.height(), std::uint8_t{9});
    return image;
  }();
  GrayImage result = backend->MakeImage<std::uint8_t>(160, 120);
  for (int factor = 1; factor <= 16; ++factor) {
    GrayImage small = backend->MakeImage<std::uint8_t>(160 / factor, 120 / factor);
    backend->MakeDecimate()->Run(source, factor, small);
  }
  backend->MakeWarp()->Run(source, kIdentity3, result);
  for (const int frames : {1, 13, 32, 33, 96, 97, 255}) {
    backend->MakeTemporalMedian()->Run(std::vector<const GrayImage*>(frames, &source), 1, result);
  }
  for (const int side : {16, 32, 64, 128, 256, 512}) {
    PhaseCorrelationSettings settings;
    settings.tile_width = side;
    settings.tile_height = side;
    settings.tiles = {{}};
    const auto correlation = backend->MakePhaseCorrelation(settings);
    const auto spectra = correlation->MakeSpectra();
    correlation->Transform(source, kIdentity3, *spectra);
    TilePeak peak;
    correlation->Correlate(*spectra, *spectra, {&peak, 1});
  }
  EXPECT_EQ(folder_.Files().size(), warm);
}

TEST_F(OpenClTest, DamagedCacheFilesAreReplaced) {
  context_->Compile(kAddCl);
  ASSERT_EQ(folder_.Files().size(), 1u);
  const std::filesystem::path file = folder_.Files().front();
  const auto size = std::filesystem::file_size(file);
  const std::vector<std::function<void()>> damages = {
      [&] { std::filesystem::resize_file(file, size / 2); },
      [&] { std::filesystem::resize_file(file, 3); },
      [&] { std::filesystem::resize_file(file, 0); },
      [&] { std::ofstream(file, std::ios::app) << "more"; },
      [&] {
        std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
        stream.seekp(static_cast<std::streamoff>(size) - 100);
        stream.put('\x5a').put('\x5a');
      },
      [&] { std::ofstream(file, std::ios::trunc) << std::string(size, 'x'); },
  };
  for (const auto& damage : damages) {
    damage();
    const auto context = MakeContext();
    const Program program = context->Compile(kAddCl);
    EXPECT_FALSE(program.from_cache);
    EXPECT_EQ(Compute(*context, program), 84);
    EXPECT_TRUE(MakeContext()->Compile(kAddCl).from_cache);
  }
  EXPECT_EQ(folder_.Files().size(), 1u);
}

// A binary that is whole but that the driver does not take, say that of another version.
TEST_F(OpenClTest, BinaryThatTheDriverRefusesIsReplaced) {
  context_->Compile(kAddCl);
  const std::filesystem::path file = folder_.Files().front();
  std::ifstream stream(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  std::uint64_t key_size = 0;
  content.copy(reinterpret_cast<char*>(&key_size), sizeof(key_size), 8);
  const std::string key = content.substr(32, key_size);
  const ProgramCache cache(folder_.path() / "cache");
  ASSERT_TRUE(cache.Load(key).has_value());
  cache.Store(key, std::vector<unsigned char>(1000, 0x42));

  const auto context = MakeContext();
  const Program program = context->Compile(kAddCl);
  EXPECT_FALSE(program.from_cache);
  EXPECT_EQ(Compute(*context, program), 84);
  EXPECT_TRUE(MakeContext()->Compile(kAddCl).from_cache);
}

TEST_F(OpenClTest, WorksWhereTheCacheCannotBeWritten) {
  const std::filesystem::path blocked = folder_.path() / "file";
  std::ofstream(blocked) << "in the way";
  for (const std::filesystem::path& folder : {blocked / "cache", std::filesystem::path()}) {
    const auto context = std::make_shared<Context>(device_, ProgramCache(folder));
    EXPECT_EQ(Compute(*context, context->Compile(kAddCl)), 84);
  }
  EXPECT_EQ(folder_.Files().size(), 1u);
}

TEST_F(OpenClTest, TellsWhatKernelsAndTransfersTookOnlyWhereItIsAskedTo) {
  std::vector<std::string> stages;
  const auto observed = std::make_shared<Context>(device_, ProgramCache({}),
                                                  [&](const std::string& stage, double ms) {
                                                    EXPECT_GE(ms, 0.0) << stage;
                                                    EXPECT_LT(ms, 1e6) << stage;
                                                    stages.push_back(stage);
                                                  });
  EXPECT_EQ(Compute(*observed, observed->Compile(kAddCl)), 84);
  EXPECT_THAT(stages, testing::ElementsAre("write", "Add", "read"));
  stages.clear();
  const auto values = observed->Allocate(sizeof(cl_int));
  values->Unmap(values->Map(Access::kRead));
  EXPECT_THAT(stages, testing::ElementsAre("map", "unmap"));

  // The queues of others do not even take the time.
  const Queue queue(*context_);
  cl_command_queue_properties properties = 0;
  ASSERT_EQ(clGetCommandQueueInfo(queue.get(), CL_QUEUE_PROPERTIES, sizeof(properties), &properties,
                                  nullptr),
            CL_SUCCESS);
  EXPECT_EQ(properties & CL_QUEUE_PROFILING_ENABLE, 0U);
}

TEST(ProgramCacheTest, KeepsBinariesApartByTheirWholeKey) {
  const TemporaryFolder folder;
  const ProgramCache cache(folder.path());
  EXPECT_FALSE(cache.Load("a").has_value());
  cache.Store("a", {1, 2, 3});
  cache.Store("b", {});
  EXPECT_EQ(cache.Load("a"), (std::vector<unsigned char>{1, 2, 3}));
  EXPECT_EQ(cache.Load("b"), std::vector<unsigned char>());
  // A file that has come to the name of another key.
  std::filesystem::copy_file(cache.FileOf("a"), cache.FileOf("c"));
  EXPECT_FALSE(cache.Load("c").has_value());
  cache.Store("a", {4});
  EXPECT_EQ(cache.Load("a"), std::vector<unsigned char>{4});
}

TEST(ProgramCacheTest, LiesInTheUsersCacheFolder) {
  const std::string home = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  setenv("XDG_CACHE_HOME", "/some/where", 1);
  EXPECT_EQ(ProgramCache::DefaultFolder(), "/some/where/windhover");
  unsetenv("XDG_CACHE_HOME");
  setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(ProgramCache::DefaultFolder(), "/home/somebody/.cache/windhover");
  unsetenv("HOME");
  EXPECT_EQ(ProgramCache::DefaultFolder(), "");
  if (!home.empty()) setenv("HOME", home.c_str(), 1);
}

}  // namespace
}  // namespace windhover::opencl
