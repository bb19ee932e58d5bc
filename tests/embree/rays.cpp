// The rays of a picture through Embree 3: how many millions a second, one at a time and in packets of eight.
//
//   c++ -O2 rays.cpp -lembree3 -lpthread -o rays && shadow bench SCENE --backends trace --rival ./rays
//
// Standard input holds, little-endian: four u32 (vertices, triangles, camera rays, shadow rays), three f32 a vertex, three u32 a triangle, seven f32 a
// ray (origin, direction, and where it ends). Written are four lines: what was sent, millions a second in the best round, and how many rays met something.
#include <embree3/rtcore.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// As many rays as a row of a picture has: what a thread takes at a time.
constexpr unsigned kChunk = 1280;
// How many numbers a ray has.
constexpr size_t kRay = 7;

template <class T> std::vector<T> read(FILE *file, size_t count) {
  std::vector<T> values(count);
  if (fread(values.data(), sizeof(T), count, file) != count) {
    fprintf(stderr, "standard input ends before all rays are there\n");
    exit(2);
  }
  return values;
}

// Lets `work(first, end)` take chunks of `count` rays on some threads; the sum of what it returns, and the seconds it took.
std::pair<unsigned, double> run(unsigned threads, unsigned count, const std::function<unsigned(unsigned, unsigned)> &work) {
  std::atomic<unsigned> next{0}, met{0};
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::thread> pool;
  for (unsigned t = 0; t < threads; ++t)
    pool.emplace_back([&] {
      for (unsigned first; (first = next.fetch_add(kChunk)) < count;) met += work(first, std::min(count, first + kChunk));
    });
  for (auto &thread : pool) thread.join();
  return {met, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

}  // namespace

int main(int argc, char **argv) {
  const unsigned threads = argc == 3 ? atoi(argv[1]) : 0, rounds = argc == 3 ? atoi(argv[2]) : 0;
  if (threads == 0 || rounds == 0) {
    fprintf(stderr, "usage: rays THREADS ROUNDS < RAYS\n");
    return 2;
  }
  const auto counts = read<unsigned>(stdin, 4);
  const auto vertices = read<float>(stdin, 3 * size_t(counts[0]));
  const auto triangles = read<unsigned>(stdin, 3 * size_t(counts[1]));
  const auto rays = read<float>(stdin, kRay * (size_t(counts[2]) + counts[3]));

  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto *positions = static_cast<float *>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, counts[0]));
  std::copy(vertices.begin(), vertices.end(), positions);
  auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, counts[1]));
  std::copy(triangles.begin(), triangles.end(), indices);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcCommitScene(scene);

  for (const bool shadow : {false, true}) {
    const unsigned count = shadow ? counts[3] : counts[2];
    const float *first_ray = rays.data() + (shadow ? kRay * counts[2] : 0);
    auto single = [&](unsigned first, unsigned end) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      unsigned met = 0;
      for (unsigned i = first; i < end; ++i) {
        const float *r = first_ray + kRay * size_t(i);
        RTCRayHit hit{{r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], ~0u, 0, 0}, {}};
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (shadow) {
          rtcOccluded1(scene, &context, &hit.ray);
          met += hit.ray.tfar < 0;
        } else {
          rtcIntersect1(scene, &context, &hit);
          met += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
      }
      return met;
    };
    auto packets = [&](unsigned first, unsigned end) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      unsigned met = 0;
      for (unsigned i = first; i < end; i += 8) {
        alignas(32) int valid[8];
        RTCRayHit8 hit{};
        for (unsigned k = 0; k < 8; ++k) {
          valid[k] = i + k < end ? -1 : 0;
          const float *r = first_ray + kRay * size_t(valid[k] ? i + k : i);
          hit.ray.org_x[k] = r[0], hit.ray.org_y[k] = r[1], hit.ray.org_z[k] = r[2];
          hit.ray.dir_x[k] = r[3], hit.ray.dir_y[k] = r[4], hit.ray.dir_z[k] = r[5];
          hit.ray.tfar[k] = r[6], hit.ray.mask[k] = ~0u;
          hit.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        if (shadow) rtcOccluded8(valid, scene, &context, &hit.ray);
        else rtcIntersect8(valid, scene, &context, &hit);
        for (unsigned k = 0; k < 8; ++k)
          met += valid[k] && (shadow ? hit.ray.tfar[k] < 0 : hit.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID);
      }
      return met;
    };
    const std::pair<const char *, std::function<unsigned(unsigned, unsigned)>> ways[] = {{"single", single}, {"packets", packets}};
    for (const auto &[name, way] : ways) {
      double best = kInfinity;
      unsigned met = 0;
      for (unsigned round = 0; round < rounds; ++round) {
        const auto [found, seconds] = run(threads, count, way);
        met = found;
        best = std::min(best, seconds);
      }
      printf("%s %s %.3f %u\n", shadow ? "shadow" : "camera", name, count / best / 1e6, met);
    }
  }
  rtcReleaseGeometry(mesh);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
