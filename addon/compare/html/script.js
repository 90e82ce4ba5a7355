// The slider between any two pictures, and the button that copies the command.
const slider = document.querySelector(".slider");
if (slider) {
    const [right, left] = slider.querySelectorAll("img");
    const range = document.querySelector(".slider + input");
    const choice = (id, change) => {
        const select = document.getElementById(id);
        const apply = () => change(select.value);
        select.addEventListener("change", apply);
        apply();
    };
    choice("left", picture => { left.src = picture; });
    choice("right", picture => { right.src = picture; });
    choice("zoom", zoom => { slider.parentElement.style.setProperty("--width", `${zoom * slider.dataset.width}px`); });

    const move = () => slider.style.setProperty("--at", `${range.value}%`);
    range.addEventListener("input", move);
    move();
    const follow = event => {
        const box = slider.getBoundingClientRect();
        range.value = 100 * (event.clientX - box.left) / box.width;
        move();
    };
    slider.addEventListener("pointerdown", event => {
        event.preventDefault();
        slider.setPointerCapture(event.pointerId);
        follow(event);
    });
    slider.addEventListener("pointermove", event => { if (event.buttons) follow(event); });
}

for (const button of document.querySelectorAll(".command button")) {
    button.addEventListener("click", () => {
        const code = button.parentElement.querySelector("code");
        getSelection().selectAllChildren(code);
        document.execCommand("copy");
        button.textContent = "Copied";
    });
}
