import QtQuick
import QtTest
import Usher.Tablet

TestCase {
    id: test
    name: "BigButton"
    when: windowShown
    width: 1080
    height: 720
    visible: true

    BigButton {
        id: button
        u: 0.5
        buttonId: "yes"
        label: "Yes"
        kind: 1
        width: wanted
    }
    BigButton {
        id: stop
        y: 300
        u: 0.5
        buttonId: "stop"
        label: "Stop"
        onPress: true
        width: wanted
    }
    Keyboard {
        id: keyboard
        y: 420
        width: 600
        height: 280
        u: 0.5
    }
    SignalSpy {
        id: clicks
        target: button
        signalName: "clicked"
    }
    SignalSpy {
        id: stops
        target: stop
        signalName: "clicked"
    }
    SignalSpy {
        id: keys
        target: keyboard
        signalName: "key"
    }

    function init() {
        clicks.clear()
        stops.clear()
        keys.clear()
    }
    function test_is_never_smaller_than_45_by_22_millimetres() {
        verify(button.width >= Theme.buttonWidth * 0.5)
        verify(button.height >= Theme.buttonHeight * 0.5)
        button.label = "A much longer label than that"
        verify(!button.cut)
        button.label = "Yes"
    }
    function test_a_touch_is_one_click() {
        mouseClick(button)
        compare(clicks.count, 1)
    }
    function test_a_touch_event_is_one_click() {
        const touch = touchEvent(button)
        touch.press(0, button).commit()
        touch.release(0, button).commit()
        compare(clicks.count, 1)
    }
    function test_a_finger_that_slides_off_is_none() {
        mousePress(button)
        mouseMove(button, button.width + 200, button.height + 200)
        mouseRelease(button, button.width + 200, button.height + 200)
        compare(clicks.count, 0)
    }
    function test_a_stop_does_not_wait_for_the_finger_to_leave() {
        mousePress(stop)
        compare(stops.count, 1)
        mouseRelease(stop)
        compare(stops.count, 1)
    }
    function test_the_return_key_is_a_click() {
        button.forceActiveFocus()
        keyClick(Qt.Key_Return)
        compare(clicks.count, 1)
    }
    function test_the_color_says_what_it_means() {
        compare(Theme.button(1), Theme.yes)
        verify(Theme.button(0) !== Theme.button(2))
    }
    function test_keys_say_their_letter_at_once() {
        mousePress(findChild(keyboard, "key:k"))
        compare(keys.count, 1)
        compare(keys.signalArguments[0][0], "k")
        mouseRelease(findChild(keyboard, "key:k"))
        compare(keys.count, 1)
    }
}
