// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Built-in actors and sequences: twice a triangle's area over its longest edge squared (a right angle of 1:1 has 0.5).
inline constexpr double kSliver = 0.02;
// Share of texels that two charts' triangles both claim: rounding along shared edges of the unwrapped surface.
inline constexpr double kTextureOverlap = 0.003;
// Share of truth vertices (mask pixels) within two pixels of the mask: half a pixel of rasterising, the rest is
// rounding.
inline constexpr double kTruthMaskShare = 0.99;
// Metres, and unit quaternions: a chain of transforms kept in floats.
inline constexpr double kFloatChain = 1e-5;
// Radians between float quaternions: the arc cosine of one less a rounding.
inline constexpr double kFloatTurn = 1e-3;
// Metres: joints.json is written with five decimals.
inline constexpr double kJointRounding = 2e-5;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;
// One network layer in float against sums in double, relative to the layer's largest value: up to 1,632 terms a sum.
inline constexpr double kLayerRelative = 2e-5;
// A whole network (up to 300 layers, recorded mask and heatmaps rounded to half precision), |a - b| / |b|.
inline constexpr double kNetworkRelative = 1e-3;
// Values computed by hand to seven digits.
inline constexpr double kHandComputed = 1e-6;
// Pixels are bytes: half a step of rounding on either side.
inline constexpr double kByteRounding = 1.0;
// Bytes rounded twice, sampled at positions rounded to 1/32 px; seen 1.01 on ramps of one step per px.
inline constexpr double kSampledBytes = 1.5;
// A network's mask in bytes, of two runs whose logits, some hundreds, agree to kNetworkRelative; seen 4.
inline constexpr int kMaskBytes = 8;
// Landmarks of a network run whose outputs agree to kNetworkRelative (1e-3 of coordinates up to 256 px and 900 mm);
// seen 1e-3.
inline constexpr double kLandmarkPx = 0.05;
inline constexpr double kLandmarkMm = 0.5;
inline constexpr double kCropAtRest = 0.1;  // share by which the crop of a person at rest changes

// Float rasteriser against a double ray caster: perspective-correct depth from three edge values of a float each.
inline constexpr double kRasterDepthRelative = 1e-4;
// Barycentric coordinate below which rounding may decide whether a pixel centre lies in a triangle.
inline constexpr double kRasterEdge = 1e-3;
// A position of up to two metres that went through float once or twice, in mm (2^-23 * 2000, a few operations).
inline constexpr double kMillimetreFloat = 2e-3;
// A direction between two such positions some 300 mm apart.
inline constexpr double kDirectionFloat = 1e-5;
// Face vertices of the recorded truth against the rest template, in mm: the face is skinned to the head and neck only,
// float32 metres, and its lower rim bends a little with the neck.
inline constexpr double kRigidFaceMm = 0.5;

// Stage II in float against double, relative norm: projections at some 300 px carry 3e-5 px of rounding, which a random
// image turns into 1e-5 of colour per tap.
inline constexpr double kSurfaceSystem = 2e-5;
// A weighted mean of at most 256 8-bit values in float.
inline constexpr double kBlurredColor = 1e-6;
inline constexpr double kBlurredGradientStep = 1e-5;
// Converged Jacobi sweeps on moves of some 25 mm added to positions of 300 mm in float, mm.
inline constexpr double kHarmonicBand = 1e-3;
// Energy after 15 inexact steps in float against 15 direct ones in double, relative.
inline constexpr double kSurfaceMinimum = 1e-3;
// Mean over the inner vertices after the standard 3 x 4 solve; regularisers and blur leave a part of the way.
inline constexpr double kRecoveredTranslationPx = 0.3;
// A mesh at rest 2 m away: float rounding of positions (1.2e-4 mm) through three steps.
inline constexpr double kSurfaceRestMm = 1e-3;
// Contour vertices of a sphere pulled 5 px with converged linear solves: what the regularisers keep, px.
inline constexpr double kContourPx = 0.2;

// Time stamps of a 25 fps file, stored as whole units of a time base of 12800 per second.
inline constexpr double kPtsMs = 0.1;
// Mean difference of 8-bit colours after H.264 at CRF 18 and 4:2:0 chroma, with small saturated squares.
inline constexpr double kVideoColour = 2.5;
// Mean colour of an empty frame against its plate: compression and gain drift leave no bias of half a step.
inline constexpr double kPlateBias = 0.5;
// Exact distance transform in float against double.
inline constexpr double kDistancePx = 1e-4;
// The same projection in double by two ways, one of them through a rotation vector.
inline constexpr double kProjectedPx = 1e-6;
// Where the middle of a person of some thousand pixels lies, drawn at half the size or against where their root is, px;
// seen 0.28.
inline constexpr double kHalfPicturePx = 0.35;
// Mean difference in bytes between a picture of 90x160 with one and with four samples a pixel; seen 1.27.
inline constexpr double kFinerPicture = 1.4;
// Brightness of a coarse sphere lit from the camera, at opposite pixels.
inline constexpr double kHeadlightBytes = 3.0;
// A picture put together again from colours and opacity, each rounded.
inline constexpr double kRecomposedBytes = 2.0;
// On which side of a line a pixel of a small picture lies, in floats.
inline constexpr double kLinePx = 1e-3;
// Bilinear sampling positions rounded to 1/32 px, colours to 1.
inline constexpr double kUndistortPx = 0.6;
// Synthetic person with noise, a shadow and a change of gain, about 450 px of border around 7500 px.
inline constexpr double kForegroundIou = 0.97;
// Pixels of one picture that device and plain C++ may decide differently: roundings at the thresholds.
inline constexpr int kForegroundDifferentPx = 4;
// The recorded sequence with a blurred mask as the gate.
inline constexpr double kRecordedForegroundIou = 0.97;
// views/foot_masks: of the lowest seventh of a drawn person, as cut and as the difference to the empty floor has it.
inline constexpr double kCutFeetIou = 0.93;
inline constexpr double kUncutFeetIou = 0.8;
// A term's residual in float: the terms subtract numbers of up to 5000 (mm, px), whose rounding is 2.4e-4 each.
inline constexpr double kTermResidual = 1e-3;
// A row of the pose stage's J on the device against double, relative to its largest entry: about 100 float operations
// from bone motions to wrenches, and differences of moments ten times larger than their result.
inline constexpr double kPoseJacobian = 5e-5;
// J^T J of some 600 float rows against the same sum in double, relative to sqrt(A_ii A_jj).
inline constexpr double kGramFloat = 3e-6;
// Differences of weights in single precision that are a tenth of them.
inline constexpr double kMatchWeight = 1e-4;
// Energies of distances of 1.5 px between places of some hundred px in single precision, 3e-5 px each.
inline constexpr double kMatchedBeside = 1e-4;
// Six Gauss-Newton steps whose float sums are added in another order: 1e-7 of the normal equations times their
// condition. Seen 1e-7 and 4e-6.
inline constexpr double kStepsRad = 1e-6;
inline constexpr double kStepsMm = 1e-4;
// And of several rounds, each of whose rows are made where the one before ended (6.9e-6 rad and 4.1e-4 mm on PoCL).
inline constexpr double kRoundsRad = 5e-5;
inline constexpr double kRoundsMm = 5e-3;
// Where a match is turned over by their last bits: 1e-3 rad where E_3D holds the legs, 0.014 seen on a GPU and 0.021 on
// PoCL where it holds them with a tenth of that.
inline constexpr double kTurnedMatchRad = 3e-2;
// And between a floor and shoes, where E_3D hardly holds the legs: 0.043 in 123 frames on PoCL. More would take a pose
// further than it is from the truth there, which is 0.057 to 0.1 with rounds ahead and without.
inline constexpr double kTurnedLegsRad = 6e-2;
// Patches moved by either body of patch_match.cl, px and shares: what is next to nothing in a window's sums, carried on
// from row to row on a CPU, moves a patch.
inline constexpr double kMatchBodies = 3e-4;
// What the device sees of an actor in floats: mm of depths up to 2 m, px^2 up to 150; normals and shares.
inline constexpr double kSightMm = 2e-3;
inline constexpr double kSight = 1e-5;
// What a GPU prepares of a round from floats against the host from doubles: weights relative to all of them, and mm of
// lengths up to 4 m.
inline constexpr double kRoundStart = 1e-6;
inline constexpr double kRoundStartMm = 2e-3;
// Keypoints after six steps on the device and on the host, both with rows in floats but with other operations; seen
// 2.3e-4. And the energy there, relative: seen 3e-6.
inline constexpr double kPeerPoseMm = 5e-3;
inline constexpr double kPeerPoseEnergy = 5e-5;
// A solver that had its model and exact data: mm between its keypoints and the true ones.
inline constexpr double kRecoveredMm = 1.0;
// A torso that is turned about its axis alone onto detections of a standing figure, rad.
inline constexpr double kTurnedTrunkRad = 0.03;
// The centre of mass by the joints, against that of the mesh's volume, which is dense alike and clothed: along the
// floor, and upwards, where trousers and shoes count.
inline constexpr double kCentreOfMassAcrossMm = 20;
inline constexpr double kCentreOfMassUpMm = 75;
// A floor learned from some hundred resting feet whose depth trembles by 8 mm: its tilt, and heights where they stood.
inline constexpr double kLearnedFloorRad = 0.02;
inline constexpr double kLearnedFloorMm = 5;
// The same heights where one foot is always 40 mm up; 19 where it counts like the one that stands.
inline constexpr double kFloorBesideLiftedFootMm = 8;
// The tilt of a floor whose tilt is given, which feet that say otherwise move by a share of it, degrees; and its height
// by soles that are level elsewhere.
inline constexpr double kGivenTiltDeg = 0.02;
inline constexpr double kHeightOverFeetMm = 30;
// One learned by a capture of 40 frames, 480 px high: its tilt, and how far it is from the camera, 4 m before the feet.
inline constexpr double kReportedFloorRad = 0.03;
inline constexpr double kReportedFloorMm = 120;
// Median squared error of the feet's depth with a known floor, as a share of that without, from keypoints 2 px off.
// 0.15 on PoCL; with eight other seeds 0.10 to 0.23.
inline constexpr double kFloorDepthShare = 0.3;
// Light by albedo that SkinLight finds where brightness is a polynomial with 5 % of noise and a seventh in shadow.
inline constexpr double kSkinLight = 0.08;
// Where a twist in steps of 5 degrees puts a wrist, px and mm.
inline constexpr double kMirroredPx = 5;
inline constexpr double kMirroredMm = 25;
// The initialisation alone: near enough for Gauss-Newton, mm.
inline constexpr double kInitializedMm = 80;
// Energy of the paper's few steps over that of a trusted solver run to convergence.
inline constexpr double kEnergyRatio = 1.01;
// Feet of a tracked figure whose detections are exact: E_temporal holds them back by a share of their way in a frame
// (some 30 mm). Feet that are some 190 mm apart and on the wrong legs, half of that.
inline constexpr double kTrackedFeetMm = 15;
inline constexpr double kExchangedFeetMm = 95;
// Angles of a hidden arm that a wrong detection pulls to the other side.
inline constexpr double kHiddenArmRad = 0.06;
// A wrist across the picture that E_temporal drew 660 mm aside, after one frame.
inline constexpr double kFoundArmMm = 150;
// Feet on a floor 30 mm too high: held by it 56 mm too near, free of it 14 mm too far, as without a floor.
inline constexpr double kFreedFeetMm = 30;
// A pelvis 0.7 rad too far round, after one step: from there as well as turned back 0.12, from there alone 0.28.
inline constexpr double kUntwistedRad = 0.15;
inline constexpr double kStillTwistedRad = 0.2;
// Knees of who squats when found, ahead of the body as they are and not half a metre behind it.
inline constexpr double kFoundKneesMm = 100;
// Of a neck that a network sees 200 mm and more too near or too far.
inline constexpr double kFoundLeanMm = 30;
// Eight decimals of a degree and of a unit along a chain of a metre and a half, in metres.
inline constexpr double kBvhMetres = 2e-7;
// Seven significant digits of a few metres.
inline constexpr double kCsvMetres = 2e-6;
// Morph targets stop when what they leave out is below 0.02 mm; int16 shapes and float weights add about as much.
inline constexpr double kMorphMeanMm = 0.05;
// The writer's own account of its error against what a viewer computes from the float32 file some metres away.
inline constexpr double kGlbReportMm = 5e-3;
// 64 shapes for 150 frames of dancing with a skirt on a rigid body (nearly all motion is residual), in mm.
inline constexpr double kClothMeanMm = 0.7;

// Heat weights posed against the author's rig over 20 test poses, mean mm: the project's bar; and without the skirt.
inline constexpr double kPosedMm = 12;
inline constexpr double kPosedBodyMm = 4.4;
// Share of the upper clothes that follows the collarbones, against the author's rig: with ribs up to 0.07 more, without
// 0.11 to 0.17.
inline constexpr double kCollarboneShare = 0.08;
// Share of the belly that follows arms and collarbones: 0.004 and 0.001, without the ribs at the waist 0.015 and 0.005.
inline constexpr double kArmsOnBelly = 0.008;
// Share of the middle of the chest that follows arms: 0; with all that heat leaves there 0.011 and 0.021.
inline constexpr double kArmsOnChest = 0.003;
// The hips' share of thighs in trousers, off the author's rig: 0.011, with the tail of heat 0.034.
inline constexpr double kHipsOnThigh = 0.02;
// The thighs' share around the knees, off the author's rig: 0.035 and 0.041, with the contact of elsewhere 0.065,
// 0.046.
inline constexpr double kThighAtKnee = 0.043;
// What is left of a lamp that makes one side of a body 2.6 times as bright as the other, of the brightness: 0.012, with
// stripes 0.013, with two materials 0.011, with rough normals 0.016. With the median for the size of residuals the
// stripes are taken for light (0.37).
inline constexpr double kShadingLeft = 0.03;
// Levels of 255 between what no picture shows and the one colour of its material: rounding. Spread from whatever is
// beside it, it is a mixture of two.
inline constexpr double kSpreadLevels = 3;
// Of the texels per mm of two charts, of edges that lie along both: the curvature of a cylinder of 80 mm under edges
// of 20.
inline constexpr double kTexelRatio = 0.05;
// Light that is left of a lamp that sets beside a room, root mean square of the logarithm: 0.012.
inline constexpr double kLampLeft = 0.02;
// The same of a ball in four pictures, whose lamp stands beside the camera before which it turned: 0.032; of a lamp
// that is taken to stand beside the ball 0.096.
inline constexpr double kTurnedLampLeft = 0.05;
// Unknowns of small linear systems in double precision, of their size.
inline constexpr double kSolvedExactly = 1e-8;
// What smoothing leaves of the noise of normals: one would leave 0.4 where neighbours had noise of their own, more
// since they share vertices.
inline constexpr double kSmoothedNormals = 0.75;
// Of a chin's weight the head's share, of a heel's the foot's; seen 0.96 to 0.99.
inline constexpr double kChinAndHeelShare = 0.85;
// The longest posed edge against the true rig's longest: a torn vertex would be ten times that.
inline constexpr double kStretchRatio = 2;
// Twisted about its own axis by up to 120 degrees a limb keeps its girth; linear blending halves it (cos 60).
inline constexpr double kTwistedGirth = 0.8;
// A tube too wide for the legs to reach hangs from the hips but for what spreads from below; one that lies on the legs
// follows them: shares.
inline constexpr double kHangingShare = 0.75;
inline constexpr double kClingingShare = 0.9;
// An actor thinned to 1400 against one thinned to 1500 vertices: chords of a trunk with edges of 45 mm.
inline constexpr double kOtherMeshMm = 3;
// Vertices laid back onto their own surface: floats of a metre and a half.
inline constexpr double kSameSurfaceMm = 0.01;
// Weights are divided by their sum in double.
inline constexpr double kWeightSum = 1e-12;
// A variance from 1600 samples of neighbouring differences, which are alike in part.
inline constexpr double kSampledVariance = 0.25;
// Skinning weights that are means of a few floats, divided by their sum.
inline constexpr double kMeanWeight = 1e-5;
// Heat on a capsule with edges of 13 mm: piecewise linear over a profile that falls to 1/e in 25 mm, and influences
// below 1 % cut.
inline constexpr double kHeatProfile = 0.06;
// Solid of a capsule of 90 vertices whose triangles straddle it, against the formula; the caps' offsets are limited.
// Seen 0.98, with the vertices on it 0.82.
inline constexpr double kFacetVolume = 0.03;
// Trilinear interpolation of a distance on a grid of 5 mm, where the surface is flat or round.
inline constexpr double kFacetOffsetMm = 0.6;
// Outlines of 24 pictures with 2.4 mm a pixel, of a limb whose triangles' edges are 12 mm: seen 0.4 mm inside in the
// mean and 1.2 at most, from 3 before.
inline constexpr double kOutlineMeanMm = 0.5;
inline constexpr double kOutlineMm = 2;

// The hull of two limbs 14 mm apart by 24 pictures from one height, triangles' edges 16 mm, faired: what is left of the
// web between them (77 % seen), what right places lose to smoothness before outlines are fitted again (0.35 mm seen),
// and how far a vertex may be beyond the hull, across whose edges it moves.
inline constexpr double kFairedShare = 0.85;
inline constexpr double kFairedMm = 0.5;
inline constexpr double kBeyondHullMm = 1.5;

// Quaternions of double precision; near opposite directions they are what 1 + cosine leaves of the digits.
inline constexpr double kTurn = 1e-12;
inline constexpr double kTurnRad = 1e-7;
inline constexpr double kNearOpposite = 1e-5;

// Pose files with eight digits.
inline constexpr double kPoseDigits = 1e-7;
// Exact rays or keypoints in double, mm; and 40 rays that are 14 mm off each (least squares on the right ones alone
// is 4.7 mm off, weights that do not know them more), 20 that look elsewhere, mean of ten draws.
inline constexpr double kTriangulatedMm = 1e-6;
inline constexpr double kTriangulatedNoisyMm = 7.5;
// A hull of 36 views in pixels of 5 mm on a grid of 12 mm: a convex solid of 120 mm radius.
inline constexpr double kHullMeanMm = 2.5;
inline constexpr double kHullMostMm = 9;
// The sphere's facets of 15 mm lie up to 0.2 mm inside of it, a grid of 10 mm cuts its curve by as much.
inline constexpr double kMeshVolumeMm = 1.0;
// Area of a sphere made of facets.
inline constexpr double kPieceShare = 0.01;

// An actor built from 70 pictures, the project's bars: surface mean and 95 %, joints, mm; labels voted and guessed.
inline constexpr double kBuiltSurfaceMm = 8;
inline constexpr double kBuiltSurfaceP95Mm = 20;
inline constexpr double kBuiltJointsMm = 20;
inline constexpr double kVotedLabels = 0.95;
inline constexpr double kGuessedLabels = 0.85;
// Of a leg's vertices in a skirt: guessed when it is known that nobody sees them, 0.64; when it is not, none.
inline constexpr double kHiddenLegs = 0.5;
inline constexpr double kFewHiddenLegs = 0.1;
// Colours of a texture where its coordinates went through nine digits of text; seen 5e-6.
inline constexpr double kTextUvColor = 1e-5;
// From the true surface to one built of 480x640 pictures, 95 %: 17 mm with the fingers cut off. And the most of an
// actor in wide folds that pictures cannot tell.
inline constexpr double kTrueToBuiltMm = 12;
inline constexpr double kConcaveShare = 0.35;
// The network's masks are blurred by some pixels of 256 over the person's crop; median.
inline constexpr double kNetworkMaskMm = 12;
// The vertical from cameras held level within 1.5 degrees, to and fro.
inline constexpr double kVerticalRad = 0.005;
// The same of a dozen cameras only, and how differently the person is then carved: half a degree.
inline constexpr double kLeanRad = 0.009;
// Where a person faces, from float positions.
inline constexpr double kFacingRad = 1e-6;
// A turn from exact keypoints, rad and mm: what is left when a step gains less than a ten-thousandth. With
// keypoints 1.5 px off, rad.
inline constexpr double kExactTurnRad = 1e-3;
inline constexpr double kExactTurnMm = 1;
inline constexpr double kNoisyTurnRad = 0.06;
// Points of a body by the poses of its turn, from masks 480 px high, whose pixels are 5 mm.
inline constexpr double kSilhouettePosesMm = 3;
// 8-bit steps: noise of 2, and what nobody saw within 6 px of a wall that changes by 4 a pixel.
inline constexpr double kFilledPlate = 34;
// A point followed by Lucas-Kanade in a smooth pattern of 8-bit grey.
inline constexpr double kTrackPx = 0.1;
// An actor from a turntable video of 480x640: the network's masks and the turn's fit on top of a build from pictures.
inline constexpr double kTurntableSurfaceMm = 8;
inline constexpr double kTurntableJointsMm = 20;
// A broken scan rebuilt on a grid of 7 mm.
inline constexpr double kScanSurfaceMm = 1.5;
// Vertex colours under the lamp of the pictures against those of the file.
inline constexpr double kColorCorrelation = 0.85;

// Calibration on rendered boards with distortion: the bar of the focal length, the principal point and the lens near
// the picture's corners in px, and the reprojection with 1.5 levels of noise; seen 0.13 %, 2.0, 2.9 (twelve views) and
// 0.08.
inline constexpr double kFocalShare = 0.005;
inline constexpr double kPrincipalPointPx = 3;
inline constexpr double kBoardRmsPx = 0.15;
// The floor's height a metre from a board on it, rendered in the same way, and the camera's tilt and roll; seen 0.7 mm.
inline constexpr double kFloorBoardMm = 5;
inline constexpr double kFloorBoardDeg = 0.5;
// Where a built-in actor's surface bends, along the bone above, from the joint: rings of vertices are 20 mm apart and
// more.
inline constexpr double kBendsAtJointMm = 15;
// The same at the ankle, where trousers hang over the shoe; seen 15.7 mm.
inline constexpr double kBendsAtAnkleMm = 18;
// Lowest vertex of a built-in actor over the floor it stands on.
inline constexpr double kOnFloorMm = 5;

// actor fit on 14 frames of 270x480 with true silhouettes and keypoints 1.5 px off: overlap (seen 0.984), share of the
// built-in actor's error that remains (seen 0.18 in the picture, 0.27 in space), lengths of bones (seen 0.059: forearm
// and hand share a number, and the person's hands were not shortened), vertices whose colour's red and blue are in the
// right order (seen 0.94 with a third of the surface seen), and how far the unchanged actor moves.
inline constexpr double kFittedOverlap = 0.975;
inline constexpr double kFittedShare = 0.4;
inline constexpr double kFittedBoneLength = 0.07;
inline constexpr double kRightColors = 0.9;
inline constexpr double kUnchangedActorMm = 6;

// Centre of a dot of five pixels whose own place is rounded to a pixel, through undistortion and JPEG.
inline constexpr double kDotPx = 0.8;

// Shares of a drape: sums in float with a doubt of a thousandth of a mm, and from matches in px of an exact drape,
// whose ways are not straight in the picture.
inline constexpr double kDrapeShare = 1e-6;
inline constexpr double kDrapeMatched = 0.02;
// Three frames of 40 to 51 small steps of cloth in float against double, mm: positions of some 400 mm, velocities from
// their differences over 0.7 ms.
inline constexpr double kClothMm = 0.05;
// How deep smoothed cloth is in a limb: over 70 mm a quarter to a third is smoothed away of the 95 mm that a thigh with
// a radius of 80 to 120 lifts it; seen 22 with edges of 30 mm, 33 with edges of 10.
inline constexpr double kSmoothedClothMm = 40;
// Mean of a skirt that falls for ten frames beside a skinned place 400 mm away, whose springs pull it: seen 20 to 24.
inline constexpr double kStartedElsewhereMm = 35;
// An oscillator in 200 first-order steps a frame, in float, against the midpoint rule in 20000, of swings of 100 mm.
inline constexpr double kOscillatorMm = 0.3;

// Which way is up by the edges of a drawn room with noise, degrees; seen 0.12.
inline constexpr double kUprightDeg = 0.4;

}  // namespace livecap::test
