import pytest
import torch
from torch import nn

from s2glib.layers import (
    PyramidFeatures,
    ResNet,
    VGGFeatures,
    load_public,
    vgg16_features,
    vgg19_features,
)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


def on_meta(make):
    with torch.device("meta"):
        return make()


def shapes(model):
    return {name: tuple(tensor.shape) for name, tensor in model.state_dict().items()}


def norm_entries(name, width):
    entries = dict.fromkeys(("weight", "bias", "running_mean", "running_var"), (width,))
    return {f"{name}.{k}": v for k, v in (entries | {"num_batches_tracked": ()}).items()}


def public_resnet18():
    """Names and shapes in the public file, written out from the ResNet paper's Table 1."""
    entries = {"conv1.weight": (64, 3, 7, 7), "fc.weight": (1000, 512), "fc.bias": (1000,)}
    entries |= norm_entries("bn1", 64)
    for layer, (before, width) in enumerate([(64, 64), (64, 128), (128, 256), (256, 512)], 1):
        for block, inputs in enumerate((before, width)):
            name = f"layer{layer}.{block}"
            entries[f"{name}.conv1.weight"] = (width, inputs, 3, 3)
            entries[f"{name}.conv2.weight"] = (width, width, 3, 3)
            entries |= norm_entries(f"{name}.bn1", width) | norm_entries(f"{name}.bn2", width)
        if layer > 1:
            entries[f"layer{layer}.0.downsample.0.weight"] = (width, before, 1, 1)
            entries |= norm_entries(f"layer{layer}.0.downsample.1", width)
    return entries


PUBLIC_VGG19 = {  # number of the convolution in `features`: outputs, inputs
    0: (64, 3), 2: (64, 64), 5: (128, 64), 7: (128, 128), 10: (256, 128), 12: (256, 256),
    14: (256, 256), 16: (256, 256), 19: (512, 256), 21: (512, 512), 23: (512, 512),
    25: (512, 512), 28: (512, 512), 30: (512, 512), 32: (512, 512), 34: (512, 512),
}  # fmt: skip
PUBLIC_VGG16 = {
    0: (64, 3), 2: (64, 64), 5: (128, 64), 7: (128, 128), 10: (256, 128), 12: (256, 256),
    14: (256, 256), 17: (512, 256), 19: (512, 512),
}  # fmt: skip


def public_vgg(convolutions, last):
    kept = {number: io for number, io in convolutions.items() if number <= last}
    weights = {f"features.{n}.weight": (*io, 3, 3) for n, io in kept.items()}
    return weights | {f"features.{n}.bias": (io[0],) for n, io in kept.items()}


def test_resnet18_is_named_as_in_the_public_file():
    assert shapes(on_meta(lambda: ResNet(1000))) == public_resnet18()


def test_resnet18_has_its_known_number_of_parameters():
    assert sum(p.numel() for p in on_meta(lambda: ResNet(1000)).parameters()) == 11_689_512


def test_resnet_halves_five_times_before_it_averages():
    seen = []
    model = on_meta(lambda: ResNet(200))
    model.avgpool.register_forward_hook(
        lambda _, inputs, out: seen.append((inputs[0].shape, out.shape))
    )
    out = model(torch.zeros(2, 3, 256, 256, device="meta"))
    assert out.shape == (2, 200)
    assert seen == [((2, 512, 8, 8), (2, 512, 1, 1))]


def test_a_small_resnet_keeps_places():
    model = ResNet(7, widths=(4, 4, 8, 8), blocks=(1, 1, 1, 1), early_pool=False, pooled=4)
    assert model.fc.in_features == 8 * 16
    assert model(torch.randn(2, 3, 64, 64)).shape == (2, 7)


def test_a_basic_block_agrees_with_its_formula():
    block = ResNet(1, widths=(4, 8, 8, 8)).eval().layer2[0]
    for module in block.modules():
        if isinstance(module, nn.BatchNorm2d):
            module.running_mean.normal_()
            module.running_var.uniform_(0.5, 2)
    x = torch.randn(2, 4, 8, 8)
    body = nn.Sequential(block.conv1, block.bn1, nn.ReLU(), block.conv2, block.bn2)
    torch.testing.assert_close(block(x), (body(x) + block.downsample(x)).clamp_min(0))


@pytest.mark.parametrize(
    ("features", "public", "last"),
    [(vgg19_features, PUBLIC_VGG19, 29), (vgg16_features, PUBLIC_VGG16, 16)],
    ids=["vgg19", "vgg16"],
)
def test_vgg_is_named_as_in_the_public_file(features, public, last):
    assert shapes(on_meta(features)) == public_vgg(public, last)


def test_vgg19_gives_five_layers_of_four_sizes():
    model = on_meta(vgg19_features)
    maps = model(torch.zeros(1, 3, 256, 256, device="meta"))
    widths, sizes = (64, 128, 256, 512, 512), (256, 128, 64, 32, 16)
    expected = [
        (1, w, s // f, s // f) for f in (1, 2, 4, 8) for w, s in zip(widths, sizes, strict=True)
    ]
    assert [tuple(m.shape) for m in maps] == expected


def test_vgg16_gives_what_the_first_three_poolings_leave():
    """[MDD B.3] i = 5, 10, 17, counted from one."""
    model = on_meta(vgg16_features)
    assert [type(model.features[i - 1]) for i in (5, 10, 17)] == [nn.MaxPool2d] * 3
    maps = model(torch.zeros(1, 3, 256, 256, device="meta"))
    assert [tuple(m.shape) for m in maps] == [(1, 64, 128, 128), (1, 128, 64, 64), (1, 256, 32, 32)]


def test_vgg_maps_are_those_of_its_layers_on_the_standardized_picture():
    model = VGGFeatures(19, (1, 6), standardize=True)
    image = torch.rand(1, 3, 16, 16)
    mean = torch.tensor([0.485, 0.456, 0.406]).view(3, 1, 1)
    std = torch.tensor([0.229, 0.224, 0.225]).view(3, 1, 1)
    first, second = model(image)
    torch.testing.assert_close(first, model.features[:2]((image - mean) / std))
    torch.testing.assert_close(second, model.features[2:7](first))


def test_vgg_is_frozen_and_lets_gradients_through():
    model = VGGFeatures(16, (4,), standardize=False)
    image = torch.rand(1, 3, 16, 16, requires_grad=True)
    model(image)[0].sum().backward()
    assert image.grad.abs().sum() > 0
    assert all(p.grad is None and not p.requires_grad for p in model.parameters())


def test_the_pyramid_sees_colours_and_edges_at_every_size():
    maps = PyramidFeatures(3)(torch.rand(2, 3, 16, 16))
    assert [tuple(m.shape[1:]) for m in maps] == [
        (3, 16, 16), (6, 16, 16), (3, 8, 8), (6, 8, 8), (3, 4, 4), (6, 4, 4)
    ]  # fmt: skip


def test_edges_are_differences_and_a_shift_of_brightness_is_none():
    image = torch.rand(1, 1, 8, 8)
    _, edges = PyramidFeatures(1, edge=2.0)(image)
    torch.testing.assert_close(edges[0, 0, 3, 4], 2 * (image[0, 0, 3, 5] - image[0, 0, 3, 4]))
    torch.testing.assert_close(edges[0, 1, 3, 4], 2 * (image[0, 0, 4, 4] - image[0, 0, 3, 4]))
    assert (edges[0, 0, :, -1] == 0).all()
    torch.testing.assert_close(PyramidFeatures(1, edge=2.0)(image + 1)[1], edges)


def test_a_small_copy_feels_a_far_displacement():
    """Moving a dot further costs more only where the picture was shrunk."""

    def dot(column):
        image = torch.zeros(1, 1, 32, 32)
        image[..., 14:18, column : column + 4] = 1
        return image

    features = PyramidFeatures(4)
    here, near, far = (features(dot(c)) for c in (2, 6, 20))
    costs = [
        [(a - b).abs().mean() for a, b in zip(here, there, strict=True)] for there in (near, far)
    ]
    assert costs[0][0] == costs[1][0]
    assert costs[0][6] < 0.9 * costs[1][6]


def test_public_weights_are_loaded_and_what_is_too_much_is_passed_over(tmp_path):
    public = VGGFeatures(16, (9,), standardize=False)
    extra = {"classifier.0.weight": torch.zeros(4096, 2)}
    torch.save(public.state_dict() | extra, tmp_path / "vgg.pth")
    model = VGGFeatures(16, (4,), standardize=False)
    load_public(model, tmp_path / "vgg.pth")
    assert torch.equal(model.features[2].weight, public.features[2].weight)


def test_a_file_of_another_network_is_refused_by_name(tmp_path):
    torch.save(nn.Linear(2, 2).state_dict(), tmp_path / "linear.pth")
    with pytest.raises(ValueError, match=r"no conv1\.weight of shape \(64, 3, 7, 7\)"):
        load_public(ResNet(10), tmp_path / "linear.pth")


@pytest.mark.parametrize("content", [b"", b"not a file of weights"])
def test_a_broken_file_is_refused(tmp_path, content):
    (tmp_path / "broken.pth").write_bytes(content)
    with pytest.raises(ValueError, match="cannot be read as weights"):
        load_public(ResNet(10), tmp_path / "broken.pth")


def test_a_list_of_tensors_and_a_missing_file_are_refused(tmp_path):
    torch.save([torch.zeros(2)], tmp_path / "list.pth")
    with pytest.raises(ValueError, match=r"has no conv1\.weight"):
        load_public(ResNet(10), tmp_path / "list.pth")
    with pytest.raises(ValueError, match="cannot be read"):
        load_public(ResNet(10), tmp_path / "nothing.pth")
