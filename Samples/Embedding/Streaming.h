// A level in square chunks, of which those near the player exist: a loader thread makes the shapes of a chunk and
// checks its bodies and joints while the world steps, and the game's thread adds them by one call between two steps.
// Which chunks exist follows from the player's place and from when the loader has finished.
#pragma once

#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

namespace fulcrum::samples {

struct ChunkPlace {
    int x = 0, z = 0;
    friend auto operator<=>(const ChunkPlace&, const ChunkPlace&) = default;
};

struct ChunkContents {
    std::vector<BodySettings> bodies;
    std::vector<BodyBatch::Joint> joints;  // of BodyBatch::Body(0), the first of the bodies, and so on
};

class ChunkStreamer {
public:
    // make(place): the contents of a chunk, called on the loader thread. size: m, of a chunk's side. reach: chunks with
    // places up to this far from the player's exist, in both directions; those one farther are removed. The system must
    // outlive the streamer.
    ChunkStreamer(PhysicsSystem& system, double size, int reach, std::function<ChunkContents(ChunkPlace)> make)
        : system_(system), size_(size), reach_(reach), make_(std::move(make)), loader_([this] { Load(); }) {}
    ~ChunkStreamer() {
        {
            const std::lock_guard lock(mutex_);
            isEnding_ = true;
        }
        wake_.notify_all();
        loader_.join();
    }
    ChunkStreamer(const ChunkStreamer&) = delete;
    ChunkStreamer& operator=(const ChunkStreamer&) = delete;

    // Between two steps: asks for the chunks near the player, adds at most `most` of those that are ready, and removes
    // those that are far away. Errors: of a chunk whose bodies are wrong, or of a call that is not allowed now.
    Status Update(const Position& player, size_t most = 1) {
        const ChunkPlace at{PlaceOf(player.x()), PlaceOf(player.z())};
        const auto isWithin = [&](const ChunkPlace& place, int reach) {
            return std::max(std::abs(place.x - at.x), std::abs(place.z - at.z)) <= reach;
        };
        for (int x = at.x - reach_; x <= at.x + reach_; ++x)
            for (int z = at.z - reach_; z <= at.z + reach_; ++z)
                if (!chunks_.contains({x, z}) && asked_.insert({x, z}).second) Ask({x, z});
        for (size_t added = 0; added < most; ++added) {
            std::optional<Ready> ready = Next();
            if (!ready) break;
            asked_.erase(ready->place);
            if (!ready->batch) return ready->batch.GetError();
            if (!isWithin(ready->place, reach_ + 1)) continue;  // the player is gone: the batch is dropped
            Result<BatchIds> ids = system_.Bodies().Commit(ready->batch.Value());
            if (!ids) return ids.GetError();
            chunks_[ready->place] = std::move(ids.Value());
        }
        for (auto chunk = chunks_.begin(); chunk != chunks_.end();) {
            if (isWithin(chunk->first, reach_ + 1)) {
                ++chunk;
                continue;
            }
            for (const BodyId id : chunk->second.bodies)  // takes its joints along
                if (Status removed = system_.Bodies().Remove(id); !removed) return removed;
            chunk = chunks_.erase(chunk);
        }
        return Done{};
    }

    // Those that exist, with their bodies and joints.
    const std::map<ChunkPlace, BatchIds>& Chunks() const { return chunks_; }

private:
    struct Ready {
        ChunkPlace place;
        Result<BodyBatch> batch;
    };

    int PlaceOf(double coordinate) const { return static_cast<int>(std::floor(coordinate / size_)); }

    void Ask(ChunkPlace place) {
        {
            const std::lock_guard lock(mutex_);
            wanted_.push_back(place);
        }
        wake_.notify_one();
    }
    std::optional<Ready> Next() {
        const std::lock_guard lock(mutex_);
        if (ready_.empty()) return std::nullopt;
        Ready ready = std::move(ready_.front());
        ready_.pop_front();
        return ready;
    }

    // On the loader thread.
    void Load() {
        std::unique_lock lock(mutex_);
        for (;;) {
            wake_.wait(lock, [&] { return isEnding_ || !wanted_.empty(); });
            if (isEnding_) return;
            const ChunkPlace place = wanted_.front();
            wanted_.pop_front();
            lock.unlock();
            ChunkContents contents = make_(place);
            Result<BodyBatch> batch = BodyBatch::Prepare(std::move(contents.bodies), std::move(contents.joints));
            lock.lock();
            ready_.push_back({place, std::move(batch)});
        }
    }

    PhysicsSystem& system_;
    double size_;
    int reach_;
    std::function<ChunkContents(ChunkPlace)> make_;
    std::map<ChunkPlace, BatchIds> chunks_;
    std::set<ChunkPlace> asked_;  // the loader makes them, or they wait to be added
    std::mutex mutex_;            // of what follows
    std::condition_variable wake_;
    std::deque<ChunkPlace> wanted_;
    std::deque<Ready> ready_;
    bool isEnding_ = false;
    std::thread loader_;
};

}  // namespace fulcrum::samples
