// The cell as bodies, joints and sensors of a Box2D world, seen from above. Callers speak metres
// and have checked every number: Debian's Box2D aborts on a NaN or a box without area.
#pragma once

#include <box2d/box2d.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "cell/rectangle.h"
#include "motion/cell_layout.h"

namespace packcell {

// Every item is in one of these states. A carried item is above the plane and touches nothing;
// items on the belt touch one another, items in the bin one another and the walls.
enum class Lying : int { kNowhere, kBelt, kHeld, kBin, kBuffer };

class World {
public:
    // For items 0..items-1, none of which is there yet.
    World(const CellLayout &cell, const Scenario &scenario, int hertz, size_t items);

    // An item comes and goes. In between it must be told at once where it lies.
    void appear(size_t index, const Item &item, const Pose &pose);
    void remove(size_t item);

    void lay_on_belt(size_t item);
    void lay_in_bin(size_t item);
    void lay_in_buffer(size_t item);

    // Puts the tool where it is now, and the item, as it lies, into its gripper.
    void take(size_t item, int arm, const Pose &tool, const Pose &where);

    // Velocities by which a tool, or what carries an item on the belt, is there after the step.
    void drive_tool(int arm, const Pose &to);
    void rest_tool(int arm);
    void drive_belt(size_t item, Point to);
    void rest_belt(size_t item);

    void step();

    // Puts the bin to sleep once nothing in it has moved since the last call. Box2D would do so
    // itself, but after half a second, in which a full bin is slow.
    void calm_bin();

    // The rest is for items that are there.
    bool there(size_t item) const { return things_[item].body != nullptr; }
    Lying lying(size_t item) const { return things_[item].lying; }
    bool moves(size_t item) const { return things_[item].body->IsAwake(); }
    Pose pose(size_t item) const;
    Rectangle rectangle(size_t item) const;  // its true sides
    Rectangle inside_of_bin() const { return inside_; }

    // Whether the photo-eye of this zone sees the item.
    bool seen(size_t item, int zone) const;

    // FNV-1a 64 of the item's state, going on from `hash`.
    uint64_t hash(uint64_t hash, size_t item) const;

private:
    struct Thing {
        b2Body *body = nullptr;
        b2Joint *joint = nullptr;   // the one that holds it
        b2Body *carrier = nullptr;  // its place on the belt
        double half_w = 0;
        double half_h = 0;
        b2Vec2 calm_at{0, 0};
        float calm_angle = 0;
        Lying lying = Lying::kNowhere;
    };

    void add_walls();
    void add_eyes(const Scenario &scenario);
    void release(Thing &thing);
    void rub(Thing &thing, b2Body *on, double acceleration);
    void drive(b2Body *body, Point to);

    const CellLayout &cell_;
    const float dt_;
    const float hertz_;
    Rectangle inside_;
    // Holds 100 kB within itself: too much for a thread's stack.
    std::unique_ptr<b2World> world_;
    b2Body *ground_ = nullptr;  // without a shape: what a joint connects does not collide
    b2Body *tools_[2] = {nullptr, nullptr};
    std::vector<b2Fixture *> eyes_;  // by zone
    std::vector<Thing> things_;
    bool stirred_ = false;  // something in the bin may move
};

}  // namespace packcell
