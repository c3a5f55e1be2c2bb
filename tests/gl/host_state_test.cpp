#include "engine/gl/host_state.h"

#include <algorithm>
#include <set>

#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "tests/gl/gl_test.h"
#include "tests/gl/poison_objects.h"

namespace viscera::test {
namespace {

using gl::HostState;

class HostStateTest : public GlTest {
  protected:
    /// A host that has something of its own bound: surfaceless contexts have no framebuffer 0 to speak of.
    void SetUp() override { gl().BindFramebuffer(GL_FRAMEBUFFER, host_.objects().framebuffer); }

    [[nodiscard]] HostState saved() {
        HostState state(gl());
        state.save(log());
        return state;
    }

    ScopedPoison host_{gl()};
    ScopedPoison poison_{gl()};
};

std::vector<GLint64> values_of(const HostState& state, const HostState::Entry& entry) {
    const auto values = state.values(entry);
    return {values.begin(), values.end()};
}

std::vector<std::string> differing_rows(const HostState& a, const HostState& b, bool raster_only = false) {
    std::vector<std::string> names;
    for (const HostState::Entry& entry : a.entries()) {
        if ((entry.row->raster || !raster_only) && !std::ranges::equal(a.values(entry), b.values(entry))) {
            names.emplace_back(entry.row->name);
        }
    }
    return names;
}

TEST_P(HostStateTest, EveryRowIsNamedOnce) {
    std::set<std::string_view> names;
    const HostState state(gl());
    for (const HostState::Entry& entry : state.entries()) {
        EXPECT_TRUE(names.insert(entry.row->name).second) << entry.row->name;
    }
    // Mesa gives 4.5 here, so no row may be missing; some drivers give exactly the 3.3 asked for.
    if (gl().VERSION_4_3 != 0) {
        EXPECT_EQ(names.size(), gl::fixed_state_rows().size() + gl::indexed_state_rows().size() +
                                    gl::binding_rows().size());
    }
}

TEST_P(HostStateTest, RowsHoldWithNothingAboveCore33) {
    gl::Functions old = gl();
    old.VERSION_4_0 = old.VERSION_4_1 = old.VERSION_4_2 = old.VERSION_4_3 = 0;
    old.KHR_debug = old.ARB_clip_control = 0;
    const auto save = [&] {
        HostState state(old);
        state.save(log());
        return state;
    };
    const HostState before = save();
    const HostState whole = saved();
    EXPECT_LE(before.entries().size(), whole.entries().size());
    for (const HostState::Entry& entry : before.entries()) {
        SCOPED_TRACE(entry.row->name);
        entry.row->poison(old, poison_.objects());
        EXPECT_NE(values_of(save(), entry), values_of(before, entry));
        before.restore();
        EXPECT_EQ(differing_rows(before, save()), std::vector<std::string>{});
    }
}

TEST_P(HostStateTest, EachPoisonChangesItsRowAndRestoreSetsItBack) {
    const HostState before = saved();
    for (const HostState::Entry& entry : before.entries()) {
        SCOPED_TRACE(entry.row->name);
        entry.row->poison(gl(), poison_.objects());
        EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
        const HostState poisoned = saved();
        EXPECT_NE(values_of(poisoned, entry), values_of(before, entry));
        before.restore();
        EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
        EXPECT_EQ(differing_rows(before, saved()), std::vector<std::string>{});
    }
}

TEST_P(HostStateTest, AllPoisonedAtOnceIsRestored) {
    const HostState before = saved();
    for (const HostState::Entry& entry : before.entries()) {
        entry.row->poison(gl(), poison_.objects());
    }
    EXPECT_GT(differing_rows(before, saved()).size(), before.entries().size() / 2);
    before.restore();
    EXPECT_EQ(differing_rows(before, saved()), std::vector<std::string>{});
}

TEST_P(HostStateTest, AHostWithEverythingSetGetsItBack) {
    // The host's own state is the unusual one; the engine's is a raster state and its own objects.
    HostState host(gl());
    for (const HostState::Entry& entry : host.entries()) {
        entry.row->poison(gl(), host_.objects());
    }
    gl().EndQuery(GL_SAMPLES_PASSED);
    {
        const gl::HostStateScope scope(host, log());
        gl::apply(gl(), gl::max_blend_state, {0, 0, 2, 2});
        for (const HostState::Entry& entry : host.entries()) {
            entry.row->poison(gl(), poison_.objects());
        }
    }
    EXPECT_EQ(differing_rows(host, saved()), std::vector<std::string>{});
    gl().PopDebugGroup();
}

TEST_P(HostStateTest, ApplyDeterminesEveryRasterRowWhateverWasBefore) {
    const gl::Rect viewport{2, 3, 20, 10};
    for (const gl::RasterState& state :
         {gl::overwrite_state, gl::max_blend_state, gl::add_blend_state, gl::depth_tested_state,
          gl::RasterState{.cull = GL_BACK,
          .scissor = gl::Rect{1, 1, 4, 4},
          .polygon_mode = GL_LINE,
          .polygon_offset = gl::PolygonOffset{1.0F, 2.0F},
          .srgb_write = true,
          .primitive_restart = 77U,
          .program_point_size = true}}) {
        const HostState fresh = saved();
        gl::apply(gl(), state, viewport);
        const HostState clean = saved();
        for (const HostState::Entry& entry : fresh.entries()) {
            if (entry.row->raster) {
                entry.row->poison(gl(), poison_.objects());
            }
        }
        gl::apply(gl(), state, viewport);
        EXPECT_EQ(differing_rows(clean, saved(), true), std::vector<std::string>{});
        fresh.restore();
    }
}

TEST_P(HostStateTest, ErrorsOfTheHostAreDrainedCountedAndReported) {
    expects_messages_ = true;
    HostState state(gl());
    gl().Enable(0xFFFF);
    state.save(log());
    EXPECT_EQ(log().faults().at("gl.host_error"), 1U);
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
    state.save(log());
    EXPECT_EQ(log().faults().at("gl.host_error"), 1U);
}

TEST_P(HostStateTest, RestoresWhenAnExceptionPasses) {
    const HostState before = saved();
    HostState state(gl());
    EXPECT_TRUE(error_of([&] {
        const gl::HostStateScope scope(state, log());
        gl::apply(gl(), gl::depth_tested_state, {0, 0, 3, 3});
        throw Error(ErrorCode::gl, "test", "thrown inside");
    }));
    EXPECT_EQ(differing_rows(before, saved()), std::vector<std::string>{});
}

TEST_P(HostStateTest, AnActiveQueryOfTheHostStaysActive) {
    gl().BeginQuery(GL_ANY_SAMPLES_PASSED, host_.objects().query);
    HostState state(gl());
    { const gl::HostStateScope scope(state, log()); }
    GLint query = 0;
    gl().GetQueryiv(GL_ANY_SAMPLES_PASSED, GL_CURRENT_QUERY, &query);
    EXPECT_EQ(static_cast<GLuint>(query), host_.objects().query);
    gl().EndQuery(GL_ANY_SAMPLES_PASSED);
}

TEST_P(HostStateTest, RunningTransformFeedbackIsPausedAndResumed) {
    if (gl().VERSION_4_0 == 0) {
        GTEST_SKIP() << "feedback objects came with OpenGL 4.0";
    }
    const ShaderSource vertex{
        "#version 330\nout float v; void main() { v = 1.0; gl_Position = vec4(0.0); }", {}, {}};
    const std::string varying = "v";
    const gl::Program program(gl(), vertex, {}, "feedback", std::span(&varying, 1));
    program.use();
    gl().BindVertexArray(host_.objects().vertex_array);
    gl().BindTransformFeedback(GL_TRANSFORM_FEEDBACK, host_.objects().feedback);
    gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, host_.objects().buffer);
    gl().BeginTransformFeedback(GL_POINTS);
    HostState state(gl());
    state.save(log());
    GLint paused = 0;
    gl().GetIntegerv(GL_TRANSFORM_FEEDBACK_BUFFER_PAUSED, &paused);
    EXPECT_EQ(paused, 1);
    gl().UseProgram(poison_.objects().program);  // an error while feedback runs
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
    state.restore();
    GLint active = 0;
    gl().GetIntegerv(GL_TRANSFORM_FEEDBACK_BUFFER_PAUSED, &paused);
    gl().GetIntegerv(GL_TRANSFORM_FEEDBACK_BUFFER_ACTIVE, &active);
    EXPECT_EQ(paused, 0);
    EXPECT_EQ(active, 1);
    gl().EndTransformFeedback();
}

INSTANTIATE_TEST_SUITE_P(Backends, HostStateTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test
