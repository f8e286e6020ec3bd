#include "cell/world.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/bytes.h"

namespace packcell {

namespace {

// Box2D keeps shapes apart by a skin and lets them overlap by a slop, both fixed lengths in its
// own units. At 50 units a metre they are .2 and .1 mm, and shapes that are smaller by the skin
// less half the slop come to rest where the true sides touch.
constexpr double kUnits = 50;
constexpr double kInset = b2_polygonRadius - 0.5 * b2_linearSlop;

constexpr int kIterations = 8;
constexpr double kGravity = 9.81;  // m/s^2, of friction on the ground: the world is seen from above
constexpr double kFriction = 0.5;
constexpr double kEye = 0.002;        // half the side of what a photo-eye sees, metres
constexpr float kCalm = 5e-5f;        // 1 um, in units
constexpr float kCalmTurn = 1e-5f;    // radians
constexpr double kWallBehind = 0.05;  // metres, so that an item in a thin wall is pushed back in

enum Category : uint16_t { kOnBelt = 1, kInBin = 2, kWall = 4, kEyes = 8, kAbove = 16 };

b2Filter filter(int category, int mask) {
    b2Filter f;
    f.categoryBits = static_cast<uint16>(category);
    f.maskBits = static_cast<uint16>(mask);
    return f;
}

float units(double metres) { return static_cast<float>(metres * kUnits); }
b2Vec2 units(Point p) { return {units(p.x), units(p.y)}; }

b2PolygonShape box(double half_w, double half_h) {
    b2PolygonShape shape;
    shape.SetAsBox(static_cast<float>(half_w * kUnits - kInset),
                   static_cast<float>(half_h * kUnits - kInset));
    return shape;
}

// Box2D fills a table at the first contact of the process, without a lock.
void warm_up() {
    static std::once_flag once;
    std::call_once(once, [] {
        const auto world = std::make_unique<b2World>(b2Vec2(0, 0));
        b2PolygonShape shape;
        shape.SetAsBox(1, 1);
        for (int i = 0; i < 2; ++i) {
            b2BodyDef def;
            def.type = b2_dynamicBody;
            world->CreateBody(&def)->CreateFixture(&shape, 1);
        }
        world->Step(1.0f / 60, 1, 1);
    });
}

std::unique_ptr<b2World> fresh_world() {
    warm_up();
    auto world = std::make_unique<b2World>(b2Vec2(0, 0));
    // Nothing is fast enough to pass through anything in a step.
    world->SetContinuousPhysics(false);
    return world;
}

}  // namespace

World::World(const CellLayout &cell, const Scenario &scenario, int hertz, size_t items)
    : cell_(cell),
      dt_(1.0f / static_cast<float>(hertz)),
      hertz_(static_cast<float>(hertz)),
      inside_{{cell.bin.centre, 0}, cell.bin.grid.bin_w / 2000, cell.bin.grid.bin_h / 2000},
      world_(fresh_world()),
      things_(items) {
    const b2BodyDef still;
    ground_ = world_->CreateBody(&still);
    add_walls();
    add_eyes(scenario);
    b2BodyDef def;
    def.type = b2_kinematicBody;
    for (b2Body *&tool : tools_) tool = world_->CreateBody(&def);
}

void World::add_walls() {
    const double half = (cell_.bin.wall + kWallBehind) / 2;
    const double w = inside_.half_w;
    const double h = inside_.half_h;
    const b2BodyDef still;
    b2Body *const walls = world_->CreateBody(&still);
    const auto add = [&](Point off, double half_w, double half_h) {
        b2PolygonShape shape;
        shape.SetAsBox(static_cast<float>(half_w * kUnits - kInset),
                       static_cast<float>(half_h * kUnits - kInset), units(cell_.bin.centre + off),
                       0);
        b2FixtureDef def;
        def.shape = &shape;
        def.friction = 0.3f;
        def.filter = filter(kWall, kInBin);
        walls->CreateFixture(&def);
    };
    add({0, h + half}, w + 2 * half, half);
    add({0, -h - half}, w + 2 * half, half);
    add({w + half, 0}, half, h + 2 * half);
    add({-w - half, 0}, half, h + 2 * half);
}

void World::add_eyes(const Scenario &scenario) {
    const b2BodyDef still;
    b2Body *const eyes = world_->CreateBody(&still);
    for (int zone = 0; zone < scenario.n_max(); ++zone) {
        b2PolygonShape shape;
        shape.SetAsBox(units(kEye), units(kEye), units(zone_centre(cell_, scenario, zone)), 0);
        b2FixtureDef def;
        def.shape = &shape;
        def.isSensor = true;
        def.filter = filter(kEyes, kOnBelt);
        eyes_.push_back(eyes->CreateFixture(&def));
    }
}

void World::appear(size_t index, const Item &item, const Pose &pose) {
    Thing &thing = things_[index];
    thing.half_w = item_side(cell_, item.w) / 2;
    thing.half_h = item_side(cell_, item.h) / 2;
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = units(pose.at);
    def.angle = static_cast<float>(pose.yaw);
    thing.body = world_->CreateBody(&def);
    const b2PolygonShape shape = box(thing.half_w, thing.half_h);
    b2FixtureDef fixture;
    fixture.shape = &shape;
    fixture.density = 1;
    fixture.friction = 0.3f;
    fixture.filter = filter(kAbove, 0);
    thing.body->CreateFixture(&fixture);
}

void World::release(Thing &thing) {
    if (thing.joint != nullptr) world_->DestroyJoint(thing.joint);
    thing.joint = nullptr;
    if (thing.carrier != nullptr) world_->DestroyBody(thing.carrier);
    thing.carrier = nullptr;
}

// Friction that can give the item so much acceleration, and as much turn at half its diagonal.
void World::rub(Thing &thing, b2Body *on, double acceleration) {
    b2FrictionJointDef def;
    def.Initialize(on, thing.body, thing.body->GetPosition());
    const float force = thing.body->GetMass() * units(acceleration);
    def.maxForce = force;
    def.maxTorque = force * units(std::hypot(thing.half_w, thing.half_h)) / 2;
    thing.joint = world_->CreateJoint(&def);
}

void World::remove(size_t item) {
    release(things_[item]);
    world_->DestroyBody(things_[item].body);
    things_[item] = Thing();
}

void World::lay_on_belt(size_t item) {
    Thing &thing = things_[item];
    release(thing);
    b2BodyDef def;
    def.type = b2_kinematicBody;
    def.position = thing.body->GetPosition();
    thing.carrier = world_->CreateBody(&def);
    // Items do not slip on the belt.
    rub(thing, thing.carrier, 4 * std::max(kGravity, cell_.belt.acceleration));
    thing.body->GetFixtureList()->SetFilterData(filter(kOnBelt, kOnBelt | kEyes));
    thing.lying = Lying::kBelt;
}

void World::lay_in_bin(size_t item) {
    Thing &thing = things_[item];
    release(thing);
    rub(thing, ground_, kFriction * kGravity);
    thing.body->GetFixtureList()->SetFilterData(filter(kInBin, kInBin | kWall));
    thing.body->SetAwake(true);
    thing.lying = Lying::kBin;
    stirred_ = true;
}

void World::lay_in_buffer(size_t item) {
    Thing &thing = things_[item];
    release(thing);
    rub(thing, ground_, kFriction * kGravity);
    thing.lying = Lying::kBuffer;
}

void World::take(size_t item, int arm, const Pose &tool, const Pose &where) {
    Thing &thing = things_[item];
    release(thing);
    b2Body *const hand = tools_[arm];
    hand->SetTransform(units(tool.at), static_cast<float>(tool.yaw));
    hand->SetLinearVelocity({0, 0});
    hand->SetAngularVelocity(0);
    thing.body->SetTransform(units(where.at), static_cast<float>(where.yaw));
    thing.body->GetFixtureList()->SetFilterData(filter(kAbove, 0));
    b2WeldJointDef def;
    def.Initialize(hand, thing.body, thing.body->GetPosition());
    thing.joint = world_->CreateJoint(&def);
    thing.lying = Lying::kHeld;
}

void World::drive(b2Body *body, Point to) {
    body->SetLinearVelocity(hertz_ * (units(to) - body->GetPosition()));
}

void World::drive_tool(int arm, const Pose &to) {
    b2Body *const hand = tools_[arm];
    drive(hand, to.at);
    const double turn = std::remainder(to.yaw - static_cast<double>(hand->GetAngle()), 2 * kPi);
    hand->SetAngularVelocity(hertz_ * static_cast<float>(turn));
}

void World::rest_tool(int arm) {
    tools_[arm]->SetLinearVelocity({0, 0});
    tools_[arm]->SetAngularVelocity(0);
}

void World::drive_belt(size_t item, Point to) {
    if (things_[item].carrier != nullptr) drive(things_[item].carrier, to);
}

void World::rest_belt(size_t item) {
    if (things_[item].carrier != nullptr) things_[item].carrier->SetLinearVelocity({0, 0});
}

void World::step() { world_->Step(dt_, kIterations, kIterations); }

void World::calm_bin() {
    if (!stirred_) return;
    bool moved = false;
    for (Thing &thing : things_) {
        if (thing.lying != Lying::kBin || !thing.body->IsAwake()) continue;
        const b2Vec2 &at = thing.body->GetPosition();
        const float angle = thing.body->GetAngle();
        moved = moved || b2DistanceSquared(at, thing.calm_at) > kCalm * kCalm ||
                b2Abs(angle - thing.calm_angle) > kCalmTurn;
        thing.calm_at = at;
        thing.calm_angle = angle;
    }
    if (moved) return;
    for (const Thing &thing : things_)
        if (thing.lying == Lying::kBin) thing.body->SetAwake(false);
    stirred_ = false;
}

Pose World::pose(size_t item) const {
    const b2Body *const body = things_[item].body;
    const b2Vec2 &at = body->GetPosition();
    return {{static_cast<double>(at.x) / kUnits, static_cast<double>(at.y) / kUnits},
            static_cast<double>(body->GetAngle())};
}

Rectangle World::rectangle(size_t item) const {
    return {pose(item), things_[item].half_w, things_[item].half_h};
}

bool World::seen(size_t item, int zone) const {
    if (zone < 0 || static_cast<size_t>(zone) >= eyes_.size()) return false;
    const b2Fixture *const eye = eyes_[static_cast<size_t>(zone)];
    const b2ContactEdge *edge = things_[item].body->GetContactList();
    for (; edge != nullptr; edge = edge->next) {
        const b2Contact *const contact = edge->contact;
        if (contact->IsTouching() &&
            (contact->GetFixtureA() == eye || contact->GetFixtureB() == eye))
            return true;
    }
    return false;
}

uint64_t World::hash(uint64_t hash, size_t item) const {
    const b2Body *const body = things_[item].body;
    uint8_t bytes[16];
    ByteWriter writer(bytes, sizeof bytes);
    writer.i32(static_cast<int32_t>(things_[item].lying));
    if (body != nullptr) {
        writer.f32(body->GetPosition().x);
        writer.f32(body->GetPosition().y);
        writer.f32(body->GetAngle());
    }
    return fnv1a(hash, bytes, writer.size());
}

}  // namespace packcell
